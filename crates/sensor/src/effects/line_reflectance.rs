//! Line reflectance: the lines reflect `1 + change` times what `camera.toml` says.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Opposite, Parameter, Stage, values},
    surface::Surface,
    text::Unit,
};

#[derive(Debug)]
pub(super) struct LineReflectance;

const ABOUT: About = About {
    id: "line_reflectance",
    name: "the lines are brighter than camera.toml says",
    because: "the lines are brighter by the same factor everywhere and in every frame, and the carpet is not",
    opposite: Some(Opposite {
        name: "the lines are darker than camera.toml says",
        because: "the lines are darker by the same factor everywhere and in every frame, and the carpet is not",
    }),
    noun: "another brightness of the lines",
    rank: 260,
    unit: Unit::Percent,
    stage: Stage::World,
    parameters: &[Parameter::size("change", "1", [-0.8, 2.0], 0.02)],
    covariates: &[Covariate::Frame],
    needs: &[Need::NominalReflectance],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "measure the brightness of the lines anew, and state its trust in camera.toml",
};

impl Effect for LineReflectance {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let change = estimates.get("change")?.in_unit(Unit::Percent);
        Some(format!("the lines are {} than stated", change.with_direction(["brighter", "darker"])))
    }

    fn reflectance(&self, p: &[f64], surface: Surface) -> f64 {
        let [change] = values(p);
        if surface == Surface::Line { 1.0 + change } else { 1.0 }
    }
}
