//! Black level: the sensor outputs a positive value without light.
//!
//! The output for a linear value `v` is `offset + (1 − offset) · v`: full scale stays full scale.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct BlackLevel;

const ABOUT: About = About {
    id: "black_level",
    name: "dark places are brighter than they should be",
    because: "dark places are brighter by the same amount of light everywhere, and bright ones hardly are",
    opposite: Some(Opposite {
        name: "dark places are darker than they should be",
        because: "dark places are darker by the same amount of light everywhere, and bright ones hardly are",
    }),
    noun: "another black",
    rank: 170,
    unit: Unit::Percent,
    stage: Stage::Sensor,
    parameters: &[Parameter::size("offset", "1", [-0.05, 0.2], 0.004)],
    covariates: &[Covariate::Intensity],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "bring places into the picture that are nearly black and places that are bright",
};

impl Effect for BlackLevel {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let offset = estimates.get("offset")?.in_unit(Unit::PercentOfFullScale);
        Some(format!("black is {}", offset.with_direction(["brighter", "darker"])))
    }

    fn respond(&self, p: &[f64], linear: f64) -> f64 {
        let [offset] = values(p);
        offset + (1.0 - offset) * linear
    }
}
