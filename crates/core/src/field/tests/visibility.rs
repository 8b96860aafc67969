use std::f64::consts::PI;

use glam::DVec2;

use super::*;
use crate::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    pose::{CameraPose, Pose2},
};

fn fisheye() -> Camera {
    let k = [-0.058061286, 0.008174184, -0.000916262, 0.000047755];
    let lens = Distortion::OpencvFisheye(OpencvFisheye { k });
    Camera::new([640, 480], [214.906223, 214.906223, 319.5, 239.5], lens).unwrap()
}

fn any_camera() -> impl Strategy<Value = Camera> {
    let lens = Distortion::Opencv(Opencv { k1: -0.3, k2: 0.08, p1: 0.001, p2: -0.002, k3: 0.0 });
    let webcam = Camera::new([640, 480], [420.0, 425.0, 310.0, 250.0], lens).unwrap();
    prop_oneof![Just(fisheye()), Just(webcam)]
}

fn any_pose() -> impl Strategy<Value = CameraPose> {
    (-3.0..3.0, -2.0..2.0, -PI..PI, 0.3..1.5, 0.0..1.2, -0.3..0.3).prop_map(
        |(x, y, yaw, height, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), height, pitch, roll),
    )
}

/// Projects a point on the ground, wherever it is, into `camera` at `pose`.
fn pixel_of(camera: &Camera, pose: CameraPose, ground: DVec2) -> DVec2 {
    camera.project(pose.camera_from_world(ground.extend(0.0))).unwrap()
}

/// Returns whether a point on the ground is among the samples seen on the paper's field.
fn is_seen(pose: CameraPose, ground: DVec2) -> bool {
    let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
    let sample = LineSample {
        point_in_world: ground,
        tangent_in_world: DVec2::Y,
        length_m: 0.01,
        clearance_m: 1.0,
        curve: 0,
    };
    !visible_samples(&field, &[sample], &fisheye(), pose, 1.0).is_empty()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn normals_and_widths_are_those_of_the_projected_line(
        field in any_preset(), camera in any_camera(), pose in any_pose(),
    ) {
        let samples = sample_lines(&field, 0.1);
        for visible in visible_samples(&field, &samples, &camera, pose, 3.0) {
            let VisibleSample { sample, pixel, normal_in_image, half_width_px } = visible;
            let centre = sample.point_in_world;
            prop_assert!((normal_in_image.length() - 1.0).abs() < 1e-9);
            prop_assert!(pixel.distance(pixel_of(&camera, pose, centre)) < 1e-9);
            let step = 1e-6 * sample.tangent_in_world;
            let project = |ground: DVec2| {
                camera.project_unbounded(pose.camera_from_world(ground.extend(0.0))).unwrap()
            };
            let along = project(centre + step) - project(centre - step);
            prop_assert!(normal_in_image.dot(along).abs() < 1e-4 * along.length() + 1e-9);
            let half_width = sample.normal_in_world() * field.line_width_m / 2.0;
            let across = pixel_of(&camera, pose, centre + half_width) - pixel_of(&camera, pose, centre - half_width);
            prop_assert!(half_width_px > 0.0);
            prop_assert!((half_width_px - 0.5 * across.dot(normal_in_image)).abs() < 1e-6);
        }
    }

    #[test]
    fn samples_keep_their_distance_in_the_picture(camera in any_camera(), pose in any_pose(), spacing_px in 1.0..40.0) {
        let field = FieldDimensions::preset("spl").unwrap();
        let visible = visible_samples(&field, &sample_lines(&field, 0.02), &camera, pose, spacing_px);
        for pair in visible.windows(2).filter(|pair| pair[0].sample.curve == pair[1].sample.curve) {
            prop_assert!(pair[0].pixel.distance(pair[1].pixel) >= spacing_px);
        }
    }

    #[test]
    fn what_is_dropped_is_out_of_view_or_behind_a_post(camera in any_camera(), pose in any_pose()) {
        // Without posts and without thinning, visibility depends on the view alone.
        let field = FieldDimensions { goal_post_diameter_m: 0.0, ..FieldDimensions::preset("spl").unwrap() };
        let samples = sample_lines(&field, 0.1);
        let expected = samples.iter().filter(|sample| {
            let half_width = sample.normal_in_world() * field.line_width_m / 2.0;
            [DVec2::ZERO, half_width, -half_width].iter().all(|&offset| {
                camera.project(pose.camera_from_world((sample.point_in_world + offset).extend(0.0))).is_ok()
            })
        });
        prop_assert_eq!(visible_samples(&field, &samples, &camera, pose, 0.0).len(), expected.count());
    }
}

#[test]
fn a_post_hides_what_is_behind_it_and_under_it() {
    // The posts of the goal at +x stand at (3, ±0.8), 0.05 in radius.
    let pose = CameraPose::new(Pose2::new(1.0, 0.8, 0.0), 0.5, 0.3, 0.0);
    assert!(is_seen(pose, DVec2::new(2.9, 0.8)), "in front of the post");
    assert!(is_seen(pose, DVec2::new(2.94, 0.8)), "right at its foot");
    assert!(!is_seen(pose, DVec2::new(3.0, 0.8)), "the post stands on it");
    assert!(!is_seen(pose, DVec2::new(3.2, 0.8)), "behind the post");
    assert!(!is_seen(pose, DVec2::new(3.2, 0.83)), "behind the post's edge");
    assert!(is_seen(pose, DVec2::new(3.2, 0.9)), "beside the post");
    assert!(is_seen(pose, DVec2::new(3.0, 0.7)), "between the posts");
}

#[test]
fn a_camera_above_the_post_looks_over_it() {
    // Post and crossbar are 0.9 high: seen from 3.0, the shadow of a post 2 m ahead ends after 0.86 m.
    let pose = CameraPose::new(Pose2::new(1.0, 0.8, 0.0), 3.0, 0.8, 0.0);
    assert!(!is_seen(pose, DVec2::new(3.5, 0.8)), "in the post's shadow");
    assert!(is_seen(pose, DVec2::new(4.5, 0.8)), "beyond it");
}

#[test]
fn what_is_out_of_view_is_dropped() {
    let pose = CameraPose::new(Pose2::new(0.0, 0.0, 0.0), 0.5, 0.3, 0.0);
    assert!(is_seen(pose, DVec2::new(2.0, 0.0)));
    assert!(!is_seen(pose, DVec2::new(-2.0, 0.0)), "behind the camera");
    assert!(!is_seen(CameraPose { pitch_rad: -1.4, ..pose }, DVec2::new(2.0, 0.0)), "below the picture");
}

#[test]
fn a_camera_in_the_carpet_or_nowhere_sees_no_line() {
    let pose = CameraPose::new(Pose2::new(0.1, 0.1, 0.0), 0.5, 0.3, 0.0);
    let field = FieldDimensions::preset("spl").unwrap();
    for pose in [CameraPose { height_m: f64::NAN, ..pose }, CameraPose { x_m: f64::INFINITY, ..pose }] {
        assert_eq!(visible_samples(&field, &sample_lines(&field, 0.1), &fisheye(), pose, 1.0), []);
    }
    let flat = CameraPose { height_m: 0.0, pitch_rad: 0.0, ..pose };
    let visible = visible_samples(&field, &sample_lines(&field, 0.1), &fisheye(), flat, 1.0);
    assert!(visible.iter().all(|sample| sample.half_width_px > 0.0));
}
