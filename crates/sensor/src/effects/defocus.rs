//! Defocus: the lens is out of focus.
//!
//! The blur is a Gaussian of standard deviation `sigma_px`; its variance adds to that of the nominal point spread function.

use super::phrases::plain;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct Defocus;

const ABOUT: About = About {
    id: "defocus",
    name: "the lens is out of focus",
    because: "all edges are wider than they should be, in every direction and also when nothing moves",
    opposite: None,
    noun: "a blur",
    rank: 70,
    unit: Unit::Pixels,
    stage: Stage::Lens,
    parameters: &[Parameter::square("sigma_px", "px", 5.0, 0.15)],
    covariates: &[Covariate::Frame, Covariate::Pixel],
    needs: &[Need::NominalSharpness],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "stand still and look at near lines in good light",
};

impl Effect for Defocus {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let sigma = estimates.get("sigma_px")?;
        Some(plain("edges are blurred with a standard deviation of", sigma, Unit::Pixels))
    }

    fn blur_variance_px2(&self, p: &[f64], _radius: f64) -> f64 {
        let [sigma_px] = values(p);
        sigma_px * sigma_px
    }
}
