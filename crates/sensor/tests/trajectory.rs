//! Interpolated trajectories of a camera.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use reality_sim_core::pose::{CameraPose, wrap_angle};
use reality_sim_sensor::{Trajectory, TrajectoryError};

/// Generates stamped poses of a camera that moves and turns at random.
fn any_way(longest_step_s: f64) -> impl Strategy<Value = Vec<(f64, CameraPose)>> {
    let pose = ([-3.0..3.0, -2.0..2.0, -3.1..3.1], [0.3..0.8, -1.2..1.2, -3.1..3.1])
        .prop_map(|(planar, rest)| common::pose(planar, rest));
    proptest::collection::vec((0.05..longest_step_s, pose), 1..12).prop_map(|steps| {
        let mut time_s = -1.0;
        steps
            .into_iter()
            .map(|(step_s, pose)| {
                time_s += step_s;
                (time_s, pose)
            })
            .collect()
    })
}

fn difference(a: CameraPose, b: CameraPose) -> f64 {
    let rotation = a.rotation_world_from_camera() - b.rotation_world_from_camera();
    let turned = rotation.to_cols_array().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    turned.max(a.position_in_world().distance(b.position_in_world()))
}

/// Computes ω of `R' = R [ω]` by finite differences.
fn angular_velocity_in_camera(trajectory: &Trajectory, time_s: f64) -> DVec3 {
    let step_s = 1e-6;
    let rotation = |time_s: f64| trajectory.at(time_s).rotation_world_from_camera();
    let change: DMat3 = (rotation(time_s + step_s) - rotation(time_s - step_s)) * (0.5 / step_s);
    let cross = rotation(time_s).transpose() * change;
    DVec3::new(cross.y_axis.z, cross.z_axis.x, cross.x_axis.y)
}

proptest! {
    #[test]
    fn passes_through_its_poses(way in any_way(1.5)) {
        let trajectory = Trajectory::new(&way).unwrap();
        for (time_s, pose) in way {
            prop_assert!(difference(trajectory.at(time_s), pose) < 1e-9);
        }
    }

    #[test]
    fn velocity_is_the_derivative_of_the_pose(way in any_way(1.5), place in 0.001f64..0.999) {
        let trajectory = Trajectory::new(&way).unwrap();
        let time_s = way[0].0 - 0.15 + place * (way[way.len() - 1].0 - way[0].0 + 0.3);
        prop_assume!(way.iter().all(|(knot_s, _)| (knot_s - time_s).abs() > 1e-4));
        let step_s = 1e-6;
        let [before, after] = [time_s - step_s, time_s + step_s].map(|time_s| trajectory.at(time_s).position_in_world());
        let twist = trajectory.velocity(time_s);
        prop_assert!(twist.velocity_in_world.distance((after - before) * (0.5 / step_s)) < 1e-4);
        let turning = angular_velocity_in_camera(&trajectory, time_s);
        prop_assert!(twist.angular_velocity_in_camera.distance(turning) < 1e-4, "{twist:?} {turning}");
    }

    #[test]
    fn neither_speed_nor_acceleration_jumps_between_near_poses(way in any_way(0.6)) {
        let trajectory = Trajectory::new(&way).unwrap();
        let speed = |time_s| trajectory.velocity(time_s).velocity_in_world;
        let step_s = 1e-5;
        for (time_s, _) in way.iter().skip(1).take(way.len().saturating_sub(2)) {
            prop_assert!(speed(time_s - 1e-9).distance(speed(time_s + 1e-9)) < 1e-4);
            let before = (speed(*time_s) - speed(time_s - step_s)) / step_s;
            let after = (speed(time_s + step_s) - speed(*time_s)) / step_s;
            // Over one step, the acceleration changes by its own slope, which grows with its size over the steps.
            prop_assert!(before.distance(after) < 2e-3 * (1.0 + before.length()) / 0.05, "{before} {after}");
        }
    }

    #[test]
    fn goes_straight_on_for_a_moment_outside_its_poses_and_stands_then(way in any_way(0.6)) {
        let trajectory = Trajectory::new(&way).unwrap();
        let ends = [(way[0].0, -1.0), (way[way.len() - 1].0, 1.0)];
        for (end_s, side) in ends {
            let velocity = trajectory.velocity(end_s).velocity_in_world;
            let position = |time_s: f64| trajectory.at(time_s).position_in_world();
            for (ahead_s, continued_s) in [(0.1, 0.1), (0.2, 0.2), (5.0, 0.2)] {
                let expected = position(end_s) + side * continued_s * velocity;
                prop_assert!(position(end_s + side * ahead_s).distance(expected) < 1e-9);
            }
            prop_assert_eq!(trajectory.velocity(end_s + side * 0.3).velocity_in_world, DVec3::ZERO);
        }
    }
}

#[test]
fn far_apart_poses_are_joined_by_a_straight_line() {
    let at = |x_m: f64| common::pose([x_m, 0.0, 0.0], [0.5, 0.4, 0.0]);
    // A single curve through all of these would overshoot by metres.
    let times_s = [0.0, 0.1, 0.2, 2.2, 2.3, 2.4];
    let places_m = [0.0, 0.5, 1.0, 1.0, 0.5, 0.0];
    let way: Vec<_> = times_s.into_iter().zip(places_m.map(at)).collect();
    let trajectory = Trajectory::new(&way).unwrap();
    for i in 0..=20 {
        let time_s = 0.2 + 0.1 * f64::from(i);
        assert!((trajectory.at(time_s).x_m - 1.0).abs() < 1e-9);
    }
}

#[test]
fn angles_are_interpolated_the_short_way_round() {
    let turned = |yaw_rad: f64, roll_rad: f64| {
        common::pose([0.0, 0.0, wrap_angle(yaw_rad)], [0.5, 0.4, wrap_angle(roll_rad)])
    };
    let way: Vec<_> =
        (0..20).map(|i| 0.2 * f64::from(i)).map(|t| (t, turned(2.0 * t, 3.0 - 2.0 * t))).collect();
    let trajectory = Trajectory::new(&way).unwrap();
    for i in 0..=76 {
        let time_s = 0.05 * f64::from(i);
        let pose = trajectory.at(time_s);
        assert!(wrap_angle(pose.yaw_rad - 2.0 * time_s).abs() < 1e-9);
        assert!(wrap_angle(pose.roll_rad - 3.0 + 2.0 * time_s).abs() < 1e-9);
    }
}

#[test]
fn a_trajectory_of_equal_poses_is_still() {
    let pose = common::pose([1.0, 2.0, 3.0], [0.5, 0.4, 0.1]);
    let still = Trajectory::still(pose);
    let same = Trajectory::new(&[(1.0, pose), (2.0, pose), (2.1, pose)]).unwrap();
    for trajectory in [&still, &same] {
        assert!(trajectory.is_still());
        for time_s in [-1e9, 0.0, 1.7, 1e9] {
            assert_eq!(trajectory.at(time_s), pose);
        }
    }
    let moves = Trajectory::new(&[(1.0, pose), (2.0, CameraPose { x_m: 1.001, ..pose })]).unwrap();
    assert!(!moves.is_still());
    assert!(still.at(f64::NAN).x_m.is_nan() && moves.at(f64::NAN).x_m.is_nan());
}

#[test]
fn poses_that_define_no_trajectory_are_refused() {
    let pose = common::pose([0.0; 3], [0.5, 0.0, 0.0]);
    let strange = CameraPose { roll_rad: f64::NAN, ..pose };
    let cases = [
        (vec![], TrajectoryError::NoPoses),
        (vec![(0.0, pose), (f64::INFINITY, pose)], TrajectoryError::NotFinite { index: 1 }),
        (vec![(0.0, strange)], TrajectoryError::NotFinite { index: 0 }),
        (vec![(1.0, pose), (1.0, pose)], TrajectoryError::NotIncreasing { previous_s: 1.0, time_s: 1.0 }),
    ];
    for (way, expected) in cases {
        let error = Trajectory::new(&way).unwrap_err();
        assert_eq!(error, expected);
        assert!(!error.to_string().contains('\n') && error.to_string().contains(": "));
    }
}

/// Returns the pose of a camera that walks, nods and sways.
fn gait(time_s: f64) -> CameraPose {
    let phase = 2.0 * std::f64::consts::PI * 0.83 * time_s;
    let planar = [0.27 * time_s, 0.006 * phase.sin(), 0.5 * (0.7 * time_s).sin()];
    common::pose(
        planar,
        [0.5 + 0.006 * (2.0 * phase).cos(), 0.4 + 0.02 * (2.0 * phase).sin(), 0.026 * phase.sin()],
    )
}

/// Returns poses at a rate with uniform noise of this standard deviation, metres and radians.
fn captured(rate_hz: f64, noise: f64) -> Vec<(f64, CameraPose)> {
    let mut state = 7_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        noise * 12_f64.sqrt() * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    let noisy = |time_s: f64, next: &mut dyn FnMut() -> f64| {
        let p = gait(time_s);
        common::pose(
            [p.x_m + next(), p.y_m + next(), p.yaw_rad + next()],
            [p.height_m + next(), p.pitch_rad + next(), p.roll_rad + next()],
        )
    };
    (0..(12.0 * rate_hz) as usize).map(|i| i as f64 / rate_hz).map(|t| (t, noisy(t, &mut next))).collect()
}

/// Returns the root mean square errors of position (m) and velocity (m/s), and of pitch (rad) and its rate (rad/s).
fn errors(trajectory: &Trajectory) -> [f64; 4] {
    let times: Vec<f64> = (100..1100).map(|i| 0.01 * f64::from(i) + 0.003).collect();
    let step_s = 1e-5;
    let of = |time_s: &f64| {
        let (found, truth) = (trajectory.at(*time_s), gait(*time_s));
        let slope = |at: &dyn Fn(f64) -> f64| (at(time_s + step_s) - at(time_s - step_s)) / (2.0 * step_s);
        [
            found.position_in_world().distance(truth.position_in_world()),
            slope(&|t| trajectory.at(t).x_m) - slope(&|t| gait(t).x_m),
            found.pitch_rad - truth.pitch_rad,
            slope(&|t| trajectory.at(t).pitch_rad) - slope(&|t| gait(t).pitch_rad),
        ]
    };
    let squares =
        times.iter().map(of).fold([0.0; 4], |sum: [f64; 4], e| std::array::from_fn(|i| sum[i] + e[i] * e[i]));
    squares.map(|square| (square / times.len() as f64).sqrt())
}

#[test]
fn noise_of_motion_capture_is_smoothed_and_gives_no_absurd_velocities() {
    for (rate_hz, noise) in [(100.0, 0.001), (100.0, 0.003), (100.0, 0.005), (300.0, 0.003)] {
        let poses = captured(rate_hz, noise);
        let [raw_m, raw_m_per_s, ..] = errors(&Trajectory::new(&poses).unwrap());
        let [m, m_per_s, rad, rad_per_s] = errors(&Trajectory::near(&poses).unwrap());
        assert!(m < 0.6 * raw_m && rad < 0.7 * noise, "{rate_hz} {noise}: {m} {rad}");
        assert!(m_per_s < 0.1 * raw_m_per_s, "{rate_hz} {noise}: {m_per_s} after {raw_m_per_s}");
        assert!(
            m_per_s < 20.0 * noise && rad_per_s < 20.0 * noise,
            "{rate_hz} {noise}: {m_per_s} {rad_per_s}"
        );
    }
}

#[test]
fn exact_poses_are_kept_and_sparse_ones_are_not_smoothed() {
    let [m, _, rad, rad_per_s] = errors(&Trajectory::near(&captured(100.0, 0.0)).unwrap());
    assert!(m < 1e-5 && rad < 1e-5 && rad_per_s < 1e-3, "{m} {rad} {rad_per_s}");
    let sparse = captured(5.0, 0.003);
    let trajectory = Trajectory::near(&sparse).unwrap();
    assert!(sparse.iter().all(|(time_s, pose)| difference(trajectory.at(*time_s), *pose) < 1e-9));
}
