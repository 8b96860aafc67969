//! `instrumental_motions`: motions that stand for those of the odometry's steps when a scale is fitted.

use reality_sim_core::{
    pose::{CameraPose, Motion2, Pose2},
    sequence::Sequence,
};
use reality_sim_sensor::Trajectory;

use super::sequence;
use crate::{
    linear_model::odometry_steps::instrumental_motions,
    recording::{Frame, OdometryStep, Recording, ReferenceSource},
};

/// Time between frames, seconds.
const INTERVAL_S: f64 = 0.2;

/// Returns a walk along x with steps of these lengths. Frames with an index in `gaps` have no odometry to the next one.
fn walk<'a>(sequence: &'a Sequence, steps_m: &[f64], gaps: &[usize]) -> Recording<'a> {
    let mut x_m = 0.0;
    let places = std::iter::once(0.0).chain(steps_m.iter().map(|step| {
        x_m += step;
        x_m
    }));
    let poses: Vec<(f64, CameraPose)> = (0..)
        .zip(places)
        .map(|(index, x_m)| {
            let pose = CameraPose::new(Pose2::new(x_m, 0.0, 0.0), 0.5, 0.4, 0.0);
            (INTERVAL_S * f64::from(index), pose)
        })
        .collect();
    let frames = (0..poses.len())
        .map(|index| {
            let until_s = INTERVAL_S * (index + 1) as f64;
            let has_step = index < steps_m.len() && !gaps.contains(&index);
            // The odometry itself must not matter.
            let odometry = Motion2 { forward_m: 99.0, left_m: 99.0, turn_rad: 1.0 };
            Frame {
                index_in_sequence: index,
                time_s: poses[index].0,
                step: has_step.then_some(OdometryStep { until_s, odometry }),
                stated_attitude_rad: None,
            }
        })
        .collect();
    let trajectory = Trajectory::new(&poses).unwrap();
    Recording {
        sequence,
        trajectory,
        frames,
        source: ReferenceSource::Measured,
        left_out: Vec::new(),
        searched: Default::default(),
        simplification: None,
    }
}

fn forward_m(steps_m: &[f64], gaps: &[usize]) -> Vec<Option<f64>> {
    let sequence = sequence();
    let recording = walk(&sequence, steps_m, gaps);
    let frames: Vec<&Frame> = recording.frames.iter().collect();
    let motions = instrumental_motions(&recording, &frames);
    motions.into_iter().map(|motion| motion.map(|motion| motion.forward_m)).collect()
}

fn assert_steps(found: &[Option<f64>], wanted: &[Option<f64>]) {
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(wanted) {
        match (found, wanted) {
            (Some(found), Some(wanted)) => assert!((found - wanted).abs() < 1e-9, "{found} for {wanted}"),
            _ => assert_eq!(found.is_some(), wanted.is_some()),
        }
    }
}

#[test]
fn a_motion_is_the_mean_of_the_second_and_third_neighbours_on_both_sides() {
    let steps_m = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8];
    let mean = |indices: &[usize]| {
        Some(indices.iter().map(|&index| steps_m[index]).sum::<f64>() / indices.len() as f64)
    };
    let wanted = [
        mean(&[2, 3]),
        mean(&[3, 4]),
        mean(&[0, 4, 5]),
        mean(&[0, 1, 5, 6]),
        mean(&[1, 2, 6, 7]),
        mean(&[2, 3, 7]),
        mean(&[3, 4]),
        mean(&[4, 5]),
        None,
    ];
    assert_steps(&forward_m(&steps_m, &[]), &wanted);
}

#[test]
fn a_frame_without_odometry_has_no_motion_and_is_no_neighbour() {
    let steps_m = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2];
    let wanted =
        [Some(0.8), Some((0.8 + 1.6) / 2.0), None, Some((0.1 + 0.2 + 3.2) / 3.0), Some(0.2), Some(0.8), None];
    assert_steps(&forward_m(&steps_m, &[2]), &wanted);
}

#[test]
fn a_step_without_neighbours_keeps_its_own_motion() {
    assert_steps(&forward_m(&[0.3, 0.5], &[]), &[Some(0.3), Some(0.5), None]);
    assert_steps(&forward_m(&[0.3, 0.5, 0.7], &[2]), &[Some(0.3), Some(0.5), None, None]);
}
