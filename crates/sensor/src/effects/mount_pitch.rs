//! Mount pitch: the camera looks lower or higher than its mount says.
//!
//! The camera is turned about its own x axis after the nominal orientation: the optical axis turns down.

use glam::DQuat;
use reality_sim_core::pose::CameraPose;

use super::adjustments::turned;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct MountPitch;

const ABOUT: About = About {
    id: "mount_pitch",
    name: "the camera looks lower than the robot believes",
    because: "lines lie too high in every picture, by the same angle near and far",
    opposite: Some(Opposite {
        name: "the camera looks higher than the robot believes",
        because: "lines lie too low in every picture, by the same angle near and far",
    }),
    noun: "a mount that looks up or down",
    rank: 20,
    unit: Unit::Degrees,
    stage: Stage::Mount,
    parameters: &[Parameter::size("pitch_rad", "rad", [-0.15, 0.15], 0.0009)],
    covariates: &[Covariate::Row, Covariate::Range, Covariate::Bearing],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at near and far lines with the head level, lowered and rolled to both sides",
};

impl Effect for MountPitch {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(estimates.get("pitch_rad")?.in_unit(Unit::Degrees).with_direction(["too low", "too high"]))
    }

    fn mount(&self, p: &[f64], pose: CameraPose) -> CameraPose {
        let [pitch_rad] = values(p);
        // Down is positive: y turns away from z.
        turned(pose, DQuat::from_rotation_x(-pitch_rad))
    }
}
