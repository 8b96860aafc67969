//! Carpet reflectance: the carpet reflects `1 + change` times what `camera.toml` says.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Opposite, Parameter, Stage, values},
    surface::Surface,
    text::Unit,
};

#[derive(Debug)]
pub(super) struct CarpetReflectance;

const ABOUT: About = About {
    id: "carpet_reflectance",
    name: "the carpet is brighter than camera.toml says",
    because: "the carpet is brighter by the same factor everywhere and in every frame, and the lines are not",
    opposite: Some(Opposite {
        name: "the carpet is darker than camera.toml says",
        because: "the carpet is darker by the same factor everywhere and in every frame, and the lines are not",
    }),
    noun: "another brightness of the carpet",
    rank: 250,
    unit: Unit::Percent,
    stage: Stage::World,
    parameters: &[Parameter::size("change", "1", [-0.8, 2.0], 0.02)],
    covariates: &[Covariate::Frame],
    needs: &[Need::NominalReflectance],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "measure the carpet's brightness anew, and state its trust in camera.toml",
};

impl Effect for CarpetReflectance {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let change = estimates.get("change")?.in_unit(Unit::Percent);
        Some(format!("the carpet is {} than stated", change.with_direction(["brighter", "darker"])))
    }

    fn reflectance(&self, p: &[f64], surface: Surface) -> f64 {
        let [change] = values(p);
        if surface == Surface::Carpet { 1.0 + change } else { 1.0 }
    }
}
