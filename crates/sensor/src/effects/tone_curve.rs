//! Tone curve: the camera maps light to pixel values by a different curve.
//!
//! `gamma_change` is added to the gamma, `contrast` to the S-shaped bend of the curve ([`Tone`]).

use super::phrases::outstanding;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::{Uncertain, Unit},
    tone::{InvalidTone, Tone},
};

#[derive(Debug)]
pub(super) struct ToneCurve;

const ABOUT: About = About {
    id: "tone_curve",
    name: "brightness is encoded by another curve",
    because: "values between dark and bright are shifted, by their brightness alone",
    opposite: None,
    noun: "another tone curve",
    rank: 180,
    unit: Unit::Plain,
    stage: Stage::Encoding,
    parameters: &[
        Parameter::size("gamma_change", "1", [-1.2, 1.2], 0.03),
        Parameter::size("contrast", "1", [-0.8, 0.8], 0.03),
    ],
    covariates: &[Covariate::Intensity],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "bring places of many brightnesses into the picture, between black and full white",
};

impl Effect for ToneCurve {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let changes = [
            (("gamma is", ["higher", "lower"]), estimates.get("gamma_change")?),
            (("the curve's middle is", ["steeper", "flatter"]), estimates.get("contrast")?),
        ];
        let text = |((subject, words), change): ((&str, [&str; 2]), Uncertain)| {
            format!("{subject} {}", change.in_unit(Unit::Plain).with_direction(words))
        };
        Some(outstanding(&changes).into_iter().map(text).collect::<Vec<String>>().join(", "))
    }

    fn tone(&self, p: &[f64], tone: Tone) -> Result<Tone, InvalidTone> {
        let [gamma_change, contrast] = values(p);
        Tone::new(tone.gamma + gamma_change, tone.contrast + contrast)
    }
}
