//! Camera yaw: the camera is turned about the vertical against the frame of its reference poses.
//!
//! The heading is added to that of the reference pose. A camera that looks down is thereby turned about its own vertical
//! axis and about its optical axis.

use reality_sim_core::pose::CameraPose;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct CameraYaw;

const ABOUT: About = About {
    id: "camera_yaw",
    name: "the camera is turned to the left against its reference poses",
    because: "lines lie too far right in every picture, by the same angle about the vertical near and far",
    opposite: Some(Opposite {
        name: "the camera is turned to the right against its reference poses",
        because: "lines lie too far left in every picture, by the same angle about the vertical near and far",
    }),
    noun: "a camera that is turned to the side",
    rank: 102,
    unit: Unit::Degrees,
    stage: Stage::Mount,
    parameters: &[Parameter::size("yaw_rad", "rad", [-0.15, 0.15], 0.0009)],
    covariates: &[Covariate::Pixel, Covariate::Bearing],
    needs: &[Need::MeasuredPoses],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at near and far lines with the head lowered, raised and rolled to both sides, with measured poses",
};

impl Effect for CameraYaw {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let words = ["to the left, seen from above", "to the right, seen from above"];
        Some(estimates.get("yaw_rad")?.in_unit(Unit::Degrees).with_direction(words))
    }

    fn mount(&self, p: &[f64], pose: CameraPose) -> CameraPose {
        let [yaw_rad] = values(p);
        CameraPose { yaw_rad: pose.yaw_rad + yaw_rad, ..pose }
    }
}
