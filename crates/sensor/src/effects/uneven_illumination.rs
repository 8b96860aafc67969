//! Uneven illumination: lamps light some parts of the field more than others.
//!
//! The light's logarithm is a polynomial of the third degree in the position on the field, in units of half the field's
//! length and width. It has no constant term: that would be the exposure.

use glam::DVec2;
use reality_sim_core::field::FieldDimensions;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Parameter, Stage, values},
    text::{Unit, digits},
};

/// Plausible values of every coefficient.
const RANGE: [f64; 2] = [-1.5, 1.5];
/// Material size: two percent of the light at the field's lines.
const MATERIAL: f64 = 0.02;
/// Bound of the exponent, because a cubic is unbounded far outside the field: light is at least e⁻³ and at most e³ times the
/// nominal one.
const LARGEST_EXPONENT: f64 = 3.0;
/// Number of positions along each half axis of the field that are searched for the brightest and the darkest.
const STEPS: i32 = 20;

#[derive(Debug)]
pub(super) struct UnevenIllumination;

const ABOUT: About = About {
    id: "uneven_illumination",
    name: "some parts of the field get more light than others",
    because: "lines and carpet are brighter in some places of the field, from wherever they are seen",
    opposite: None,
    noun: "uneven light",
    rank: 160,
    unit: Unit::Percent,
    stage: Stage::World,
    parameters: &[
        Parameter::size("x", "1", RANGE, MATERIAL),
        Parameter::size("y", "1", RANGE, MATERIAL),
        Parameter::size("xx", "1", RANGE, MATERIAL),
        Parameter::size("xy", "1", RANGE, MATERIAL),
        Parameter::size("yy", "1", RANGE, MATERIAL),
        Parameter::size("xxx", "1", RANGE, MATERIAL),
        Parameter::size("xxy", "1", RANGE, MATERIAL),
        Parameter::size("xyy", "1", RANGE, MATERIAL),
        Parameter::size("yyy", "1", RANGE, MATERIAL),
    ],
    covariates: &[Covariate::FieldPosition, Covariate::Intensity],
    needs: &[Need::NominalReflectance],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "walk over the whole field and look at each part of it from several sides",
};

impl Effect for UnevenIllumination {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let value = |parameter: &Parameter| Some(estimates.get(parameter.name)?.value);
        let factors: Vec<f64> = ABOUT.parameters.iter().map(value).collect::<Option<_>>()?;
        let factors = &factors;
        let steps = || (-STEPS..=STEPS).map(|step| f64::from(step) / f64::from(STEPS));
        let places = || steps().flat_map(|x| steps().map(move |y| (exponent(factors, x, y), x, y)));
        let brightest = places().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let darkest = places().min_by(|a, b| a.0.total_cmp(&b.0))?;
        // The coefficients' errors are correlated: there is no interval to state.
        Some(format!(
            "the light is brightest {} and darkest {}, by a factor of {}",
            part_of_field(brightest.1, brightest.2),
            part_of_field(darkest.1, darkest.2),
            digits((brightest.0 - darkest.0).exp(), 2)
        ))
    }

    fn light(&self, p: &[f64], point_in_world: DVec2, field: &FieldDimensions) -> f64 {
        let DVec2 { x, y } = 2.0 * point_in_world / DVec2::new(field.length_m, field.width_m);
        exponent(&values::<9>(p), x, y).clamp(-LARGEST_EXPONENT, LARGEST_EXPONENT).exp()
    }
}

/// Returns the logarithm of the light at a position in units of half the field's length and width.
fn exponent(factors: &[f64], x: f64, y: f64) -> f64 {
    let terms = [x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y];
    factors.iter().zip(terms).map(|(factor, term)| factor * term).sum()
}

/// Names a position in units of half the field's length and width.
fn part_of_field(x: f64, y: f64) -> &'static str {
    let third = |value: f64| (1.5 * (value + 1.0)).clamp(0.0, 2.0) as usize;
    [
        ["in the corner at −x and −y", "at the end at −x", "in the corner at −x and +y"],
        ["at the side at −y", "in the middle of the field", "at the side at +y"],
        ["in the corner at +x and −y", "at the end at +x", "in the corner at +x and +y"],
    ][third(x)][third(y)]
}
