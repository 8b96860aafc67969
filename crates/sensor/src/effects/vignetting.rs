//! Vignetting: less light reaches the corners of the sensor.
//!
//! `falloff = 1 − strength ρ² − shape ρ² (ρ² − 1) − bend ρ² (ρ² − 1) (2 ρ² − 1)`: an even polynomial of the sixth degree, as
//! Goldman and Chen ("Vignette and exposure calibration and compensation", ICCV 2005) fit falloffs, in a basis whose shape
//! and bend terms vanish at the centre and at the corner.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::Unit,
};

/// Least falloff: some light reaches every pixel.
const DARKEST: f64 = 0.02;

#[derive(Debug)]
pub(super) struct Vignetting;

const ABOUT: About = About {
    id: "vignetting",
    name: "the lens darkens towards the corners",
    because: "lines and carpet darken towards the corners, with the distance from the image centre, in every frame",
    opposite: None,
    noun: "a loss of light at the corners",
    rank: 10,
    unit: Unit::Percent,
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("strength", "1", [0.0, 0.95], 0.03),
        Parameter::shape("shape", "1", [-1.0, 1.0], 0.01),
        Parameter::shape("bend", "1", [-0.4, 0.4], 0.01),
    ],
    covariates: &[Covariate::Radius, Covariate::Intensity],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "bring the same places of the field into the middle of the picture and into its corners",
};

impl Effect for Vignetting {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let lost = estimates.get("strength")?.in_unit(Unit::Percent);
        Some(format!("at the corner {} of the light is lost{}", lost.signed(), lost.interval()))
    }

    fn falloff(&self, p: &[f64], radius: f64) -> f64 {
        let [strength, shape, bend] = values(p);
        let squared = radius * radius;
        let inner = squared * (squared - 1.0);
        (1.0 - strength * squared - shape * inner - bend * inner * (2.0 * squared - 1.0)).max(DARKEST)
    }
}
