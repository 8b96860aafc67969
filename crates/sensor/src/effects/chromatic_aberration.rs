//! Lateral chromatic aberration: the lens magnifies red and blue differently from green.
//!
//! Red and blue are magnified about the principal point by `1 + scale`.

use super::phrases::against_green;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct ChromaticAberration;

const ABOUT: About = About {
    id: "chromatic_aberration",
    name: "red and blue are magnified other than green",
    because: "the edges of lines in red or blue are shifted against green in proportion to their distance from the image centre",
    opposite: None,
    noun: "fringes of colour",
    rank: 150,
    unit: Unit::Percent,
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("red_scale", "1", [-0.02, 0.02], 0.0003),
        Parameter::size("blue_scale", "1", [-0.02, 0.02], 0.0003),
    ],
    covariates: &[Covariate::Radius, Covariate::Color],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "bring sharp lines into the corners of the picture, in good light",
};

impl Effect for ChromaticAberration {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        against_green(estimates, ["red_scale", "blue_scale"], ["larger", "smaller"])
    }

    fn magnification(&self, p: &[f64]) -> [f64; 3] {
        let [red_scale, blue_scale] = values(p);
        [1.0 + red_scale, 1.0, 1.0 + blue_scale]
    }
}
