//! Mount roll: the camera is turned about its optical axis.
//!
//! The camera is turned about its own z axis after the nominal orientation: x turns towards y.

use glam::DQuat;
use reality_sim_core::pose::CameraPose;

use super::adjustments::turned;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct MountRoll;

const ABOUT: About = About {
    id: "mount_roll",
    name: "the camera is turned about its optical axis",
    because: "every picture is turned about its centre by the same angle",
    opposite: None,
    noun: "a mount that is tilted sideways",
    rank: 100,
    unit: Unit::Degrees,
    stage: Stage::Mount,
    parameters: &[Parameter::size("roll_rad", "rad", [-0.15, 0.15], 0.0009)],
    covariates: &[Covariate::Pixel, Covariate::Bearing],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at lines to the left and to the right, with the head lowered and raised",
};

impl Effect for MountRoll {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let words =
            ["clockwise, seen from behind the camera", "counter-clockwise, seen from behind the camera"];
        Some(estimates.get("roll_rad")?.in_unit(Unit::Degrees).with_direction(words))
    }

    fn mount(&self, p: &[f64], pose: CameraPose) -> CameraPose {
        let [roll_rad] = values(p);
        turned(pose, DQuat::from_rotation_z(roll_rad))
    }
}
