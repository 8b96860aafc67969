//! Places that fit a picture, and the prior knowledge about them.

use crate::{
    filter::PlanarSigma,
    pose::{CameraPose, Pose2, wrap_angle},
    refine::PoseFit,
};

/// Minimum log-probability of a prior: a clear picture outweighs a wrong prior.
const PRIOR_FLOOR: f64 = -20.0;

/// Place that fits the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Pose of the camera at this place.
    pub pose: CameraPose,
    /// Log-weight of the contrast model, including the prior.
    pub log_weight: f64,
    /// Probability of this mode among all modes found.
    pub probability: f64,
    /// Sub-pixel fit from which `pose` comes, if there is one.
    pub fit: Option<PoseFit>,
}

/// Knowledge about the pose before the picture is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Expected pose of the camera.
    pub pose: Pose2,
    /// Uncertainty of the expected pose.
    pub sigma: PlanarSigma,
}

impl Prior {
    /// Returns the log-probability of a pose, up to a constant: a normal distribution with a floor, so that a clear
    /// picture outweighs a wrong prior.
    pub(crate) fn log_probability(&self, pose: Pose2) -> f64 {
        let place =
            (pose.position_in_world() - self.pose.position_in_world()).length() / self.sigma.position_m;
        let turn = wrap_angle(pose.yaw_rad - self.pose.yaw_rad) / self.sigma.yaw_rad;
        (-0.5 * (place * place + turn * turn)).max(PRIOR_FLOOR)
    }
}
