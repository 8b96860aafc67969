//! The camera is higher or lower than its mount says.

use reality_sim_core::pose::CameraPose;

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct CameraHeight;

const ABOUT: About = About {
    id: "camera_height",
    name: "the camera is higher above the carpet than the robot believes",
    stage: Stage::Mount,
    parameters: &[Parameter::size("height_m", "m", [-0.15, 0.15], 0.004)],
    covariates: &[Covariate::Range, Covariate::Row],
    because: "near lines lie too low in every picture and far ones do not",
    recording_that_would_decide: "look at lines right in front of the robot and far away, in the same picture",
};

impl Effect for CameraHeight {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn mount(&self, p: &[f64], pose: CameraPose) -> CameraPose {
        let [height_m] = values(p);
        CameraPose { height_m: pose.height_m + height_m, ..pose }
    }
}
