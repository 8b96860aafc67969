//! The camera moves while a row is exposed.
//!
//! A pixel's value is the mean of the light over the exposure, whose middle is the row's time.

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct MotionBlur;

const ABOUT: About = About {
    id: "motion_blur",
    name: "moving pictures are blurred along their motion",
    stage: Stage::Motion,
    parameters: &[Parameter::square("exposure_s", "s", 0.1, 0.005)],
    covariates: &[Covariate::AngularRate, Covariate::Speed, Covariate::Pixel],
    because: "edges across the motion are blurred with the square of its speed, edges along it stay sharp",
    recording_that_would_decide: "walk with quick turns of the head past lines in several directions, and stand still in between",
};

impl Effect for MotionBlur {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn exposure_s(&self, p: &[f64]) -> f64 {
        let [exposure_s] = values(p);
        exposure_s.max(0.0)
    }
}
