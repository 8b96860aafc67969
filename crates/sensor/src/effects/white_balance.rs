//! Red and blue are amplified other than green.

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct WhiteBalance;

const ABOUT: About = About {
    id: "white_balance",
    name: "red and blue are amplified other than green",
    stage: Stage::Exposure,
    parameters: &[
        Parameter::size("red_gain", "1", [-0.6, 1.5], 0.01),
        Parameter::size("blue_gain", "1", [-0.6, 1.5], 0.01),
    ],
    covariates: &[Covariate::Color, Covariate::Intensity],
    because: "red or blue is brighter by the same factor everywhere and in every frame, and green is not",
    recording_that_would_decide: "look at white lines that are neither too dark nor cut off in any colour",
};

impl Effect for WhiteBalance {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn gain(&self, p: &[f64], _time_s: f64) -> [f64; 3] {
        let [red_gain, blue_gain] = values(p);
        [1.0 + red_gain, 1.0, 1.0 + blue_gain]
    }
}
