//! The camera turns light into pixel values by another curve.
//!
//! What is added to the gamma, and an S-shaped bend of the curve; see [`Tone`].

use crate::effect::{About, Covariate, Effect, Parameter, Stage, Tone, values};

#[derive(Debug)]
pub(super) struct ToneCurve;

const ABOUT: About = About {
    id: "tone_curve",
    name: "brightness is encoded by another curve",
    stage: Stage::Encoding,
    parameters: &[
        Parameter::size("gamma_change", "1", [-1.2, 1.2], 0.03),
        Parameter::size("contrast", "1", [-0.8, 0.8], 0.03),
    ],
    covariates: &[Covariate::Intensity],
    because: "values between dark and bright are shifted, by their brightness alone",
    recording_that_would_decide: "bring places of many brightnesses into the picture, between black and full white",
};

impl Effect for ToneCurve {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn tone(&self, p: &[f64], tone: Tone) -> Tone {
        let [gamma_change, contrast] = values(p);
        Tone { gamma: tone.gamma + gamma_change, contrast: tone.contrast + contrast }
    }
}
