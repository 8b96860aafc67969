//! Motion blur: the camera moves while a row is exposed.
//!
//! A pixel's value is the mean of the light over the exposure, which is centred on the row's time.

use super::phrases::plain;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct MotionBlur;

const ABOUT: About = About {
    id: "motion_blur",
    name: "moving pictures are blurred along their motion",
    because: "edges across the motion are blurred with the square of its speed, edges along it stay sharp",
    opposite: None,
    noun: "a long exposure",
    rank: 80,
    unit: Unit::Milliseconds,
    stage: Stage::Motion,
    parameters: &[Parameter::square("exposure_s", "s", 0.1, 0.005)],
    covariates: &[Covariate::AngularRate, Covariate::Speed, Covariate::Pixel],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "walk with quick turns of the head past lines in several directions, and stand still in between",
};

impl Effect for MotionBlur {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(plain("the light is gathered for", estimates.get("exposure_s")?, Unit::Milliseconds))
    }

    fn exposure_s(&self, p: &[f64]) -> f64 {
        let [exposure_s] = values(p);
        exposure_s.max(0.0)
    }
}
