//! Motion of the robot at about the time of each odometry step, from the reference poses.
//!
//! The error of a reference pose is in the motion of its own step and in the step's residual. A scale factor that is fitted to
//! both would be biased by what they have in common. The motion of neighbouring steps does not share that error and serves as
//! an instrumental variable (Wooldridge, *Econometric Analysis of Cross Section and Panel Data*, chapter 5).

use reality_sim_core::pose::Motion2;

use crate::{
    recording::{Frame, Recording},
    thresholds::Thresholds,
};

/// Least and largest distance, in steps, from a step to the neighbours whose motion stands for its own.
const NEIGHBOURS: [usize; 2] = Thresholds::DEFAULT.linear_model.instrument_steps;

/// Returns the mean motion of the neighbouring steps for each frame's step, or the step's own motion if it has no neighbour.
/// None for a frame without a step.
pub(crate) fn instrumental_motions(recording: &Recording<'_>, frames: &[&Frame]) -> Vec<Option<Motion2>> {
    let own: Vec<Option<Motion2>> = frames.iter().map(|frame| reference_motion(recording, frame)).collect();
    let [nearest, farthest] = NEIGHBOURS;
    let instrument = |index: usize| {
        let motion = own[index]?;
        let is_neighbour = |other: &usize| (nearest..=farthest).contains(&other.abs_diff(index));
        let neighbours: Vec<Motion2> =
            (0..own.len()).filter(is_neighbour).filter_map(|other| own[other]).collect();
        Some(if neighbours.is_empty() { motion } else { mean(&neighbours) })
    };
    (0..own.len()).map(instrument).collect()
}

fn mean(motions: &[Motion2]) -> Motion2 {
    let of = |number: fn(&Motion2) -> f64| motions.iter().map(number).sum::<f64>() / motions.len() as f64;
    Motion2 {
        forward_m: of(|motion| motion.forward_m),
        left_m: of(|motion| motion.left_m),
        turn_rad: of(|motion| motion.turn_rad),
    }
}

/// Returns the motion of a frame's step by the reference trajectory.
fn reference_motion(recording: &Recording<'_>, frame: &Frame) -> Option<Motion2> {
    let step = frame.step?;
    let at = |time_s: f64| recording.trajectory.at(time_s).planar();
    Some(at(frame.time_s).motion_to(at(step.until_s)))
}
