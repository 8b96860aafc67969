use std::f64::consts::PI;

use super::*;
use crate::pose::Pose2;

fn any_pose() -> impl Strategy<Value = CameraPose> {
    (-7.0..7.0, -4.5..4.5, -PI..PI, 0.2..1.6, -0.5..1.5, -0.5..0.5).prop_map(
        |(x, y, yaw, height, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), height, pitch, roll),
    )
}

fn level(height_m: f64) -> CameraPose {
    CameraPose::new(Pose2::new(1.0, 2.0, 0.0), height_m, 0.0, 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn pixel_to_ground_to_pixel(camera in any_camera(), pose in any_pose(), u in 0.0..1.0, v in 0.0..1.0) {
        let pixel = DVec2::new(u * f64::from(camera.width - 1), v * f64::from(camera.height - 1));
        if let Ok(ground) = camera.unproject_to_ground(pose, pixel) {
            prop_assume!(ground.distance(pose.planar().position_in_world()) < 1e3);
            let again = camera.project_unbounded(pose.camera_from_world(ground.extend(0.0))).unwrap();
            prop_assert!(again.distance(pixel) < 1e-6);
        }
    }

    #[test]
    fn ground_to_pixel_to_ground(camera in any_camera(), pose in any_pose(), ahead_m in 0.0..8.0_f64, around_rad in -PI..PI) {
        let ground = pose.planar().position_in_world() + ahead_m * DVec2::from_angle(around_rad);
        let in_camera = pose.camera_from_world(ground.extend(0.0));
        if angle_from_axis_rad(in_camera) > 0.95 * camera.max_angle_rad() {
            return Ok(());
        }
        let pixel = camera.project_unbounded(in_camera).unwrap();
        prop_assert!(camera.unproject_to_ground(pose, pixel).unwrap().distance(ground) < 1e-6);
    }
}

#[test]
fn the_pose_convention_in_pixels() {
    let camera = walk();
    let seen =
        |pose: CameraPose, world: [f64; 3]| camera.project(pose.camera_from_world(world.into())).unwrap();
    let pose = level(0.5);
    let centre = DVec2::new(camera.cx, camera.cy);
    assert!(seen(pose, [4.0, 2.0, 0.5]).distance(centre) < 1e-9, "level, the axis looks along the heading");
    assert!(seen(pose, [4.0, 3.0, 0.5]).x < centre.x, "world left is left in the picture");
    assert!(seen(pose, [4.0, 2.0, 0.0]).y > centre.y, "the ground is below");
    let pitched = CameraPose { pitch_rad: 0.3, ..pose };
    assert!(seen(pitched, [4.0, 2.0, 0.5]).y < centre.y, "looking down raises the horizon");
    let rolled = CameraPose { roll_rad: 0.3, ..pose };
    assert!(seen(rolled, [4.0, 1.0, 0.5]).y < centre.y, "rolled clockwise, what is right moves up");
    let turned = CameraPose { yaw_rad: 0.3, ..pose };
    assert!(seen(turned, [4.0, 2.0, 0.5]).x > centre.x, "turned left, what was ahead moves right");
}

#[test]
fn straight_down_meets_the_ground_below() {
    for camera in cameras() {
        let pose = CameraPose { pitch_rad: PI / 2.0, ..level(0.8) };
        let below = camera.unproject_to_ground(pose, DVec2::new(camera.cx, camera.cy)).unwrap();
        assert!(below.distance(DVec2::new(1.0, 2.0)) < 1e-12);
    }
}

#[test]
fn at_and_above_the_horizon() {
    let camera = walk();
    for v in [0.0, 100.0, 239.5] {
        let result = camera.unproject_to_ground(level(0.5), DVec2::new(300.0, v));
        assert_eq!(result, Err(NoRay::AboveHorizon));
    }
}

#[test]
fn a_camera_in_the_ground_sees_none() {
    let (camera, pixel) = (walk(), DVec2::new(300.0, 400.0));
    for height_m in [0.0, -0.5, f64::NAN, f64::INFINITY] {
        assert_eq!(camera.unproject_to_ground(level(height_m), pixel), Err(NoRay::NotAboveGround));
    }
    let lost = CameraPose { yaw_rad: f64::NAN, ..level(0.5) };
    assert_eq!(camera.unproject_to_ground(lost, pixel), Err(NoRay::NotAboveGround));
}
