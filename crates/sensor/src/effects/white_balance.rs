//! White balance: red and blue are amplified differently from green, by `1 + gain`.

use super::phrases::against_green;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct WhiteBalance;

const ABOUT: About = About {
    id: "white_balance",
    name: "red and blue are amplified other than green",
    because: "red or blue is brighter by the same factor everywhere and in every frame, and green is not",
    opposite: None,
    noun: "another white balance",
    rank: 140,
    unit: Unit::Percent,
    stage: Stage::Exposure,
    parameters: &[
        Parameter::size("red_gain", "1", [-0.6, 1.5], 0.01),
        Parameter::size("blue_gain", "1", [-0.6, 1.5], 0.01),
    ],
    covariates: &[Covariate::Color, Covariate::Intensity],
    needs: &[Need::NominalReflectance],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at white lines that are neither too dark nor cut off in any colour",
};

impl Effect for WhiteBalance {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        against_green(estimates, ["red_gain", "blue_gain"], ["brighter", "darker"])
    }

    fn gain(&self, p: &[f64], _time_s: f64) -> [f64; 3] {
        let [red_gain, blue_gain] = values(p);
        [1.0 + red_gain, 1.0, 1.0 + blue_gain]
    }
}
