//! The lens magnifies red and blue other than green.
//!
//! Red and blue are magnified about the principal point by 1 + scale.

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct ChromaticAberration;

const ABOUT: About = About {
    id: "chromatic_aberration",
    name: "red and blue are magnified other than green",
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("red_scale", "1", [-0.02, 0.02], 0.0003),
        Parameter::size("blue_scale", "1", [-0.02, 0.02], 0.0003),
    ],
    covariates: &[Covariate::Radius, Covariate::Color],
    because: "the edges of lines in red or blue are shifted against green in proportion to their distance from the image centre",
    recording_that_would_decide: "bring sharp lines into the corners of the picture, in good light",
};

impl Effect for ChromaticAberration {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn magnification(&self, p: &[f64]) -> [f64; 3] {
        let [red_scale, blue_scale] = values(p);
        [1.0 + red_scale, 1.0, 1.0 + blue_scale]
    }
}
