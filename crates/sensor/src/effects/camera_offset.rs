//! Camera offset: the camera is beside the place that its reference poses give, on the robot and so in the camera's heading.

use reality_sim_core::pose::{CameraPose, Motion2};

use super::phrases::outstanding;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Parameter, Stage, values},
    text::{Uncertain, Unit},
};

#[derive(Debug)]
pub(super) struct CameraOffset;

const ABOUT: About = About {
    id: "camera_offset",
    name: "the camera is not where its reference poses have it",
    because: "near lines are shifted in every picture and far ones are not, by the same distance ahead or aside of the camera",
    opposite: None,
    noun: "a camera at another place",
    rank: 124,
    unit: Unit::Centimeters,
    stage: Stage::Mount,
    parameters: &[
        Parameter::size("forward_m", "m", [-0.3, 0.3], 0.004),
        Parameter::size("left_m", "m", [-0.3, 0.3], 0.004),
    ],
    covariates: &[Covariate::Range, Covariate::Bearing],
    needs: &[Need::MeasuredPoses],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at near and far lines from the same places with other headings, with measured poses",
};

impl Effect for CameraOffset {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let offsets = [
            (["farther ahead", "farther back"], estimates.get("forward_m")?),
            (["farther left", "farther right"], estimates.get("left_m")?),
        ];
        let text =
            |(words, offset): ([&str; 2], Uncertain)| offset.in_unit(Unit::Centimeters).with_direction(words);
        let texts: Vec<String> = outstanding(&offsets).into_iter().map(text).collect();
        Some(format!("the camera is {}", texts.join(" and ")))
    }

    fn mount(&self, p: &[f64], pose: CameraPose) -> CameraPose {
        let [forward_m, left_m] = values(p);
        let place = pose.planar().moved(Motion2 { forward_m, left_m, turn_rad: 0.0 });
        CameraPose { x_m: place.x_m, y_m: place.y_m, ..pose }
    }
}
