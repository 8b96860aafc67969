//! Sharpening: the camera's software makes edges steeper by an unsharp mask, or smooths the picture against noise.
//!
//! The encoded picture `v` becomes `v + amount · (v − blurred v)`, where the blur is a Gaussian of 1 pixel.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct Sharpening;

const ABOUT: About = About {
    id: "sharpening",
    name: "the camera sharpens its pictures",
    because: "edges are steeper and noise is stronger than they should be, everywhere and in every frame",
    opposite: Some(Opposite {
        name: "the camera smooths its pictures",
        because: "edges are less steep and noise is weaker than they should be, everywhere and in every frame",
    }),
    noun: "a sharpening",
    rank: 185,
    unit: Unit::Percent,
    stage: Stage::Encoding,
    parameters: &[Parameter::size("amount", "1", [-0.9, 3.0], 0.05)],
    covariates: &[Covariate::Frame, Covariate::Pixel],
    needs: &[Need::NominalSharpness, Need::NominalNoise],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "stand still and look at near lines and plain carpet in good light",
};

impl Effect for Sharpening {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let amount = estimates.get("amount")?.in_unit(Unit::Percent);
        Some(format!("fine detail is {}", amount.with_direction(["amplified", "weakened"])))
    }

    fn sharpening(&self, p: &[f64]) -> f64 {
        let [amount] = values(p);
        amount
    }
}
