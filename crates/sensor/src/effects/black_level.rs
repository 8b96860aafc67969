//! The sensor puts out a value without light.
//!
//! `offset + (1 − offset) · v`: full scale stays full scale.

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct BlackLevel;

const ABOUT: About = About {
    id: "black_level",
    name: "dark places are brighter than they should be",
    stage: Stage::Sensor,
    parameters: &[Parameter::size("offset", "1", [-0.05, 0.2], 0.004)],
    covariates: &[Covariate::Intensity],
    because: "dark places are brighter by the same amount of light everywhere, and bright ones hardly are",
    recording_that_would_decide: "bring places into the picture that are nearly black and places that are bright",
};

impl Effect for BlackLevel {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn respond(&self, p: &[f64], linear: f64) -> f64 {
        let [offset] = values(p);
        offset + (1.0 - offset) * linear
    }
}
