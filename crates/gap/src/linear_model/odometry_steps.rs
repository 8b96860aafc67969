//! How the robot moves at about the time of each step of its odometry, by the reference poses.

use reality_sim_core::pose::Motion2;

use crate::{
    recording::{Frame, Recording},
    thresholds::Thresholds,
};

/// Fewest and most steps between a step and those that stand for it.
const AROUND: [usize; 2] = Thresholds::DEFAULT.linear_model.instrument_steps;

/// The mean of the steps before and after each: the reference poses' own errors are in a step's movement and in what it is
/// compared with, and would make a scale of what they have in common. Those of other steps have none in common with it
/// (instrumental variables). None where there is no step.
pub(crate) fn around(recording: &Recording<'_>, frames: &[&Frame]) -> Vec<Option<Motion2>> {
    let own: Vec<Option<Motion2>> = frames.iter().map(|frame| movement(recording, frame)).collect();
    let about = |index: usize| {
        let alone = own[index]?;
        let near = (0..own.len()).filter(|&other| (AROUND[0]..=AROUND[1]).contains(&other.abs_diff(index)));
        let steps: Vec<Motion2> = near.filter_map(|other| own[other]).collect();
        Some(if steps.is_empty() { alone } else { mean(&steps) })
    };
    (0..own.len()).map(about).collect()
}

fn mean(steps: &[Motion2]) -> Motion2 {
    let of = |number: fn(&Motion2) -> f64| steps.iter().map(number).sum::<f64>() / steps.len() as f64;
    Motion2 {
        forward_m: of(|step| step.forward_m),
        left_m: of(|step| step.left_m),
        turn_rad: of(|step| step.turn_rad),
    }
}

fn movement(recording: &Recording<'_>, frame: &Frame) -> Option<Motion2> {
    let step = frame.step?;
    let at = |time_s: f64| recording.trajectory.at(time_s).planar();
    Some(at(frame.time_s).motion_to(at(step.until_s)))
}
