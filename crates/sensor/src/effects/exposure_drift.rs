//! Exposure drift: the camera's exposure changes during the recording.
//!
//! The gain is 2 to the power of `ev`, which is interpolated linearly between twelve knots spread evenly from the
//! recording's start to its end; outside the recording it is constant.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::{Uncertain, Unit, percent},
};

/// Number of knots, spread evenly over the recording.
const KNOTS: usize = 12;
/// Plausible values in EV.
const RANGE: [f64; 2] = [-3.0, 3.0];
/// Material size in EV: three and a half percent of the light.
const MATERIAL: f64 = 0.05;

const fn knot(name: &'static str) -> Parameter {
    Parameter::size(name, "EV", RANGE, MATERIAL)
}

#[derive(Debug)]
pub(super) struct ExposureDrift;

const ABOUT: About = About {
    id: "exposure_drift",
    name: "the exposure changes during the recording",
    because: "whole frames are brighter or darker than others, everywhere in the picture and in all colours alike",
    opposite: None,
    noun: "a change of the exposure",
    rank: 60,
    unit: Unit::ExposureValues,
    stage: Stage::Exposure,
    parameters: &[
        Parameter::fixed("from_s", "s"),
        Parameter::fixed("to_s", "s"),
        knot("ev_01"),
        knot("ev_02"),
        knot("ev_03"),
        knot("ev_04"),
        knot("ev_05"),
        knot("ev_06"),
        knot("ev_07"),
        knot("ev_08"),
        knot("ev_09"),
        knot("ev_10"),
        knot("ev_11"),
        knot("ev_12"),
    ],
    covariates: &[Covariate::Time, Covariate::Frame, Covariate::Intensity],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: true,
    recording_that_would_decide: "look at the same places of the field again and again over the whole recording",
};

impl Effect for ExposureDrift {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let knots: Vec<Uncertain> = estimates
            .finite()
            .filter(|(name, _)| name.starts_with("ev_"))
            .map(|(_, estimate)| estimate)
            .collect();
        let by_value = |a: &&Uncertain, b: &&Uncertain| a.value.total_cmp(&b.value);
        let (darkest, brightest) = (knots.iter().min_by(by_value)?, knots.iter().max_by(by_value)?);
        let (value, sigma) = (brightest.value - darkest.value, brightest.sigma.hypot(darkest.sigma));
        let range = Uncertain { value, sigma }.in_unit(Unit::ExposureValues);
        Some(format!(
            "the brightest moment has {} more light than the darkest, {}{}",
            percent(value.exp2() - 1.0),
            range.signed(),
            range.interval()
        ))
    }

    fn gain(&self, p: &[f64], time_s: f64) -> [f64; 3] {
        let [from_s, to_s] = values(p);
        let ev = values::<{ 2 + KNOTS }>(p);
        [interpolated(&ev[2..], progress(from_s, to_s, time_s)).exp2(); 3]
    }
}

/// Returns how much of the recording has passed, 0 to 1.
fn progress(from_s: f64, to_s: f64, time_s: f64) -> f64 {
    if to_s > from_s { ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0) } else { 0.0 }
}

/// Interpolates linearly between knots that are spread evenly over 0 to 1.
fn interpolated(knots: &[f64], place: f64) -> f64 {
    let position = place * (knots.len() - 1) as f64;
    let before = (position as usize).min(knots.len() - 2);
    let rest = position - before as f64;
    knots[before] * (1.0 - rest) + knots[before + 1] * rest
}
