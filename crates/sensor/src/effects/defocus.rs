//! The lens is not in focus.
//!
//! The blur is Gaussian; its variance adds to that of the nominal point spread function.

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct Defocus;

const ABOUT: About = About {
    id: "defocus",
    name: "the lens is out of focus",
    stage: Stage::Lens,
    parameters: &[Parameter::square("sigma_px", "px", 5.0, 0.15)],
    covariates: &[Covariate::Frame, Covariate::Pixel],
    because: "all edges are wider than they should be, in every direction and also when nothing moves",
    recording_that_would_decide: "stand still and look at near lines in good light",
};

impl Effect for Defocus {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn blur_variance_px2(&self, p: &[f64], _radius: f64) -> f64 {
        let [sigma_px] = values(p);
        sigma_px * sigma_px
    }
}
