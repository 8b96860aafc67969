//! Places that a picture fits, and what was known of them before.

use crate::{
    filter::PlanarSigma,
    pose::{CameraPose, Pose2, wrap_angle},
    refine::PoseFit,
};

/// Least log-probability of a prior: a clear picture outweighs a wrong prior.
const PRIOR_FLOOR: f64 = -20.0;

/// A place the picture fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// The pose.
    pub pose: CameraPose,
    /// Log-weight by the contrast model, prior included.
    pub log_weight: f64,
    /// Probability among all modes found.
    pub probability: f64,
    /// The sub-pixel fit that `pose` comes from, where there is one.
    pub fit: Option<PoseFit>,
}

/// What is known before the picture is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Where the camera probably is.
    pub pose: Pose2,
    /// How far from there it may be.
    pub sigma: PlanarSigma,
}

impl Prior {
    /// Log-probability up to a constant; normal, but never below a floor: a clear picture outweighs a wrong prior.
    pub(crate) fn log_probability(&self, pose: Pose2) -> f64 {
        let place =
            (pose.position_in_world() - self.pose.position_in_world()).length() / self.sigma.position_m;
        let turn = wrap_angle(pose.yaw_rad - self.pose.yaw_rad) / self.sigma.yaw_rad;
        (-0.5 * (place * place + turn * turn)).max(PRIOR_FLOOR)
    }
}
