//! Veiling glare: light scattered in the lens covers the picture.
//!
//! A share of the picture's mean light is added everywhere, as ISO 9358 describes it: other than a black level, it is more in
//! bright pictures than in dark ones, and has the mean colour of what is in view.

use super::phrases::plain;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct VeilingGlare;

const ABOUT: About = About {
    id: "veiling_glare",
    name: "stray light in the lens covers the picture",
    because: "dark places are brighter by a share of the picture's mean light, more in bright pictures than in dark ones",
    opposite: None,
    noun: "stray light in the lens",
    rank: 175,
    unit: Unit::Percent,
    stage: Stage::Lens,
    parameters: &[Parameter::size("share", "1", [0.0, 1.0], 0.01)],
    covariates: &[Covariate::Frame],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at the same lines and carpet with a bright lamp or window in view, and without it",
};

impl Effect for VeilingGlare {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let share = estimates.get("share")?;
        Some(plain("the share of the mean light that is spread over the picture is", share, Unit::Percent))
    }

    fn glare(&self, p: &[f64]) -> f64 {
        let [share] = values(p);
        share
    }
}
