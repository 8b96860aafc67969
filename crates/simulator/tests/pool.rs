//! Cameras of a pool, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use glam::{DVec2, Vec3};
use reality_sim_core::pose::{CameraPose, Pose2};
use reality_sim_simulator::{Ball, CameraPool, Frame, Layer, LookError, Request};

use self::common::{camera, usual_pose};

/// Returns poses on the walk that are some way from each other.
fn poses(pool: &CameraPool) -> Vec<CameraPose> {
    let usual = usual_pose(pool.prototype());
    (0..6).map(|i| usual.with_planar(Pose2::new(-2.3, 0.2, 1.0 + 0.1 * f64::from(i)))).collect()
}

fn ball_before(pose: CameraPose) -> Ball {
    let place = DVec2::new(pose.x_m, pose.y_m) + 1.2 * DVec2::from_angle(pose.yaw_rad);
    Ball::on_ground(place.x, place.y, 0.065, Vec3::new(0.9, 0.3, 0.05))
}

#[test]
fn threads_get_the_pictures_that_one_camera_alone_would_make() {
    let pool = CameraPool::new(camera());
    let poses = poses(&pool);
    let balls: Vec<Ball> = poses.iter().map(|pose| ball_before(*pose)).collect();
    let mut alone = camera().with_decoding_ahead(false);
    let expected: Vec<Frame> = poses
        .iter()
        .zip(&balls)
        .map(|(pose, ball)| {
            let mut frame = Frame::default();
            alone.forget_path();
            alone.look(*pose, &[ball], &mut frame).unwrap();
            frame
        })
        .collect();
    std::thread::scope(|scope| {
        for thread in 0..3 {
            let (pool, poses, balls, expected) = (&pool, &poses, &balls, &expected);
            scope.spawn(move || {
                let mut frame = Frame::default();
                for step in 0..poses.len() {
                    let index = (step + 2 * thread) % poses.len();
                    let layers: [&dyn Layer; 1] = [&balls[index]];
                    pool.look(&Request::new(poses[index], &layers), &mut frame).unwrap();
                    assert_eq!(frame.picture, expected[index].picture);
                    assert_eq!(frame.objects, expected[index].objects);
                }
            });
        }
    });
}

#[test]
fn many_pictures_at_once_keep_their_order_and_one_that_is_refused_harms_no_other() {
    let pool = CameraPool::new(camera());
    let mut poses = poses(&pool);
    poses[2] = CameraPose { x_m: 20.0, ..poses[2] };
    poses[4] = CameraPose { yaw_rad: f64::NAN, ..poses[4] };
    let requests: Vec<Request> = poses.iter().map(|pose| Request::new(*pose, &[])).collect();
    let mut frames = vec![Frame::default(); requests.len()];
    let seen = pool.look_each(&requests, &mut frames);
    assert_eq!(seen.len(), requests.len());
    for (index, (seen, frame)) in seen.iter().zip(&frames).enumerate() {
        assert_eq!(seen.is_err(), [2, 4].contains(&index), "{index}: {seen:?}");
        if seen.is_ok() {
            assert_eq!(frame.pose, poses[index]);
        }
    }
    assert!(seen[2].as_ref().is_err_and(LookError::is_refusal), "{:?}", seen[2]);
    let mut frame = Frame::default();
    pool.look(&requests[0], &mut frame).unwrap();
    assert_eq!(frame.picture, frames[0].picture);
}
