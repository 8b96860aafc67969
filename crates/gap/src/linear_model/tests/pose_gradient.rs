//! `pose_gradient` against central differences of the projection.

use glam::{DMat3, DVec2, DVec3};
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    pose::{CameraPose, Pose2},
    sequence::CameraSetup,
};
use reality_sim_sensor::{Chain, Trajectory};

use super::sequence;
use crate::{linear_model::pose_gradient::pose_gradient, measurement::camera::FrameCamera};

/// Half the width of a central difference, radians or metres.
const STEP: f64 = 1e-5;
/// Allowed error of a component, as a fraction of the largest of the six.
const TOLERANCE: f64 = 1e-6;

/// Unit vectors across lines.
const NORMALS: [DVec2; 3] = [DVec2::X, DVec2::Y, DVec2::new(0.6, -0.8)];

fn cameras() -> [Camera; 3] {
    let opencv = Opencv { k1: -0.12, k2: 0.03, p1: 0.002, p2: -0.001, k3: 0.0 };
    let fisheye = OpencvFisheye { k: [-0.066, 0.0099, -0.0011, 0.000_05] };
    [
        (Distortion::Pinhole, 380.0),
        (Distortion::Opencv(opencv), 400.0),
        (Distortion::OpencvFisheye(fisheye), 212.0),
    ]
    .map(|(distortion, focal_px)| {
        Camera::new([640, 480], [focal_px, 1.02 * focal_px, 318.0, 243.0], distortion).unwrap()
    })
}

fn poses() -> [CameraPose; 3] {
    [
        CameraPose::new(Pose2::new(-0.6, 0.8, 0.4), 0.52, 0.45, 0.02),
        CameraPose::new(Pose2::new(2.1, -1.3, -2.7), 0.48, 0.3, -0.15),
        CameraPose::new(Pose2::new(0.2, 0.1, 1.9), 1.4, 0.8, 0.4),
    ]
}

/// Returns points on the ground ahead of a camera and to both sides, in the world.
fn points(pose: CameraPose) -> Vec<DVec2> {
    let ahead = [[0.7, 0.3], [1.2, -0.4], [2.5, 0.0], [3.5, 1.1]];
    ahead
        .map(|[x, y]| {
            pose.planar().position_in_world()
                + pose.height_m * DVec2::from_angle(pose.yaw_rad).rotate(DVec2::new(x, y))
        })
        .to_vec()
}

/// Runs a check on every camera, pose and visible point. Returns the number of checks.
fn for_every_point(check: impl Fn(&Camera, CameraPose, DVec2, &dyn Fn(DVec2) -> [f64; 6])) -> usize {
    let sequence = sequence();
    let mut seen = 0;
    for camera in cameras() {
        let setup = CameraSetup { camera: camera.clone(), ..sequence.setup.clone() };
        let chain = Chain::nominal(&setup, &sequence.field);
        for pose in poses() {
            let trajectory = Trajectory::still(pose);
            let frame_camera = FrameCamera::new(&chain, &trajectory, 0.0);
            for ground in points(pose) {
                if camera.project(pose.camera_from_world(ground.extend(0.0))).is_err() {
                    continue;
                }
                seen += 1;
                check(&camera, pose, ground, &|normal| pose_gradient(&frame_camera, ground, normal).unwrap());
            }
        }
    }
    seen
}

/// Returns the pixel of a point on the ground, along a normal, for a camera with this position and rotation in the world.
fn offset_px(camera: &Camera, position: DVec3, rotation: DMat3, ground: DVec2, normal: DVec2) -> f64 {
    let point_in_camera = rotation.transpose() * (ground.extend(0.0) - position);
    normal.dot(camera.project_unbounded(point_in_camera).unwrap())
}

#[test]
fn all_six_components_equal_differences_of_the_projection() {
    let seen = for_every_point(|camera, pose, ground, gradient| {
        let (position, rotation) = (pose.position_in_world(), pose.rotation_world_from_camera());
        let (sin, cos) = pose.yaw_rad.sin_cos();
        let [right, down, forward] = [DVec3::new(sin, -cos, 0.0), DVec3::NEG_Z, DVec3::new(cos, sin, 0.0)];
        for normal in NORMALS {
            let gradient = gradient(normal);
            let turned = |axis: DVec3, angle: f64| {
                offset_px(camera, position, DMat3::from_axis_angle(axis, angle) * rotation, ground, normal)
            };
            let moved =
                |axis: DVec3, by: f64| offset_px(camera, position + by * axis, rotation, ground, normal);
            let turns =
                [right, down, forward].map(|axis| (turned(axis, STEP) - turned(axis, -STEP)) / (2.0 * STEP));
            let moves = [DVec3::X, DVec3::Y, DVec3::Z]
                .map(|axis| (moved(axis, STEP) - moved(axis, -STEP)) / (2.0 * STEP));
            let largest = gradient.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            for (value, difference) in gradient.into_iter().zip(turns.into_iter().chain(moves)) {
                assert!(
                    (value - difference).abs() < TOLERANCE * largest,
                    "{camera:?} {pose:?} {ground} {normal}: {value} for {difference}"
                );
            }
        }
    });
    assert!(seen >= 24, "only {seen} points are visible");
}

#[test]
fn the_rotations_of_a_level_camera_are_pitch_up_yaw_right_and_roll_clockwise() {
    let sequence = sequence();
    let [camera, ..] = cameras();
    let setup = CameraSetup { camera: camera.clone(), ..sequence.setup.clone() };
    let chain = Chain::nominal(&setup, &sequence.field);
    let pose = CameraPose::new(Pose2::new(0.3, -0.2, 0.7), 0.5, 0.0, 0.0);
    let trajectory = Trajectory::still(pose);
    let frame_camera = FrameCamera::new(&chain, &trajectory, 0.0);
    let ground = pose.planar().position_in_world() + DVec2::from_angle(0.7).rotate(DVec2::new(1.6, 0.4));
    let offset = |pose: CameraPose, normal: DVec2| {
        offset_px(&camera, pose.position_in_world(), pose.rotation_world_from_camera(), ground, normal)
    };
    for normal in NORMALS {
        let [pitch, yaw, roll, ..] = pose_gradient(&frame_camera, ground, normal).unwrap();
        let slope = |change: fn(CameraPose, f64) -> CameraPose| {
            (offset(change(pose, STEP), normal) - offset(change(pose, -STEP), normal)) / (2.0 * STEP)
        };
        let down = slope(|pose, by| CameraPose { pitch_rad: pose.pitch_rad + by, ..pose });
        let left = slope(|pose, by| CameraPose { yaw_rad: pose.yaw_rad + by, ..pose });
        let clockwise = slope(|pose, by| CameraPose { roll_rad: pose.roll_rad + by, ..pose });
        for (value, difference) in [(pitch, -down), (yaw, -left), (roll, clockwise)] {
            assert!((value - difference).abs() < TOLERANCE * 640.0, "{value} for {difference}");
        }
    }
}
