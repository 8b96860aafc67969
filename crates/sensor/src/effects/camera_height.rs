//! Camera height: the camera is higher or lower above the ground than its mount says.

use reality_sim_core::pose::CameraPose;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct CameraHeight;

const ABOUT: About = About {
    id: "camera_height",
    name: "the camera is higher above the carpet than the robot believes",
    because: "near lines lie too low in every picture and far ones do not",
    opposite: Some(Opposite {
        name: "the camera is lower above the carpet than the robot believes",
        because: "near lines lie too high in every picture and far ones do not",
    }),
    noun: "another height of the camera",
    rank: 120,
    unit: Unit::Centimeters,
    stage: Stage::Mount,
    parameters: &[Parameter::size("height_m", "m", [-0.15, 0.15], 0.004)],
    covariates: &[Covariate::Range, Covariate::Row],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at lines right in front of the robot and far away, in the same picture",
};

impl Effect for CameraHeight {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(estimates.get("height_m")?.in_unit(Unit::Centimeters).with_direction(["too high", "too low"]))
    }

    fn mount(&self, p: &[f64], pose: CameraPose) -> CameraPose {
        let [height_m] = values(p);
        CameraPose { height_m: pose.height_m + height_m, ..pose }
    }
}
