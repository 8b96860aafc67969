//! Less light reaches the corners of the sensor.
//!
//! `falloff = 1 − strength ρ² − shape ρ² (ρ² − 1) − bend ρ² (ρ² − 1) (2 ρ² − 1)`: an even polynomial of the sixth degree, as
//! Goldman and Chen (2005) fit falloffs, in a basis in which shape and bend leave the corner and the middle as they are.

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

/// Some light reaches every pixel.
const DARKEST: f64 = 0.02;

#[derive(Debug)]
pub(super) struct Vignetting;

const ABOUT: About = About {
    id: "vignetting",
    name: "the lens darkens towards the corners",
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("strength", "1", [0.0, 0.95], 0.03),
        Parameter::shape("shape", "1", [-1.0, 1.0], 0.01),
        Parameter::shape("bend", "1", [-0.4, 0.4], 0.01),
    ],
    covariates: &[Covariate::Radius, Covariate::Intensity],
    because: "lines and carpet darken towards the corners, with the distance from the image centre, in every frame",
    recording_that_would_decide: "bring the same places of the field into the middle of the picture and into its corners",
};

impl Effect for Vignetting {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn falloff(&self, p: &[f64], radius: f64) -> f64 {
        let [strength, shape, bend] = values(p);
        let squared = radius * radius;
        let inner = squared * (squared - 1.0);
        (1.0 - strength * squared - shape * inner - bend * inner * (2.0 * squared - 1.0)).max(DARKEST)
    }
}
