//! Uneven illumination: lamps light some parts of the field more than others.
//!
//! The light's logarithm is a polynomial of the second degree in the position on the field, in units of half the field's
//! length and width. It has no constant term: that would be the exposure. Outside the rectangle in which the light was
//! measured, it is that at the rectangle's edge: a polynomial tells nothing of places that nobody has seen.

use glam::DVec2;
use reality_sim_core::field::FieldDimensions;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Role, Stage, values},
    text::{Unit, digits},
};

/// Plausible values of every coefficient.
const RANGE: [f64; 2] = [-1.5, 1.5];
/// Material size: two percent of the light at the field's lines.
const MATERIAL: f64 = 0.02;
/// Bound of the exponent, because a polynomial is unbounded far outside the field: light is at least e⁻³ and at most e³ times the
/// nominal one. It holds where no rectangle is given.
const LARGEST_EXPONENT: f64 = 3.0;
/// Number of steps along each axis of the field in which the brightest and the darkest place are searched.
const STEPS: i32 = 40;

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
        Parameter::fixed("from_x", "1"),
        Parameter::fixed("to_x", "1"),
        Parameter::fixed("from_y", "1"),
        Parameter::fixed("to_y", "1"),
    ],
    covariates: &[Covariate::FieldPosition, Covariate::Intensity],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "walk over the whole field and look at each part of it from several sides",
};

impl Effect for UnevenIllumination {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let coefficients = ABOUT.parameters.iter().filter(|parameter| parameter.role == Role::Size);
        let value = |parameter: &Parameter| Some(estimates.get(parameter.name)?.value);
        let factors: Vec<f64> = coefficients.map(value).collect::<Option<_>>()?;
        let factors = &factors;
        let edge = |name: &str| estimates.get(name).map(|edge| edge.value.clamp(-1.0, 1.0));
        let seen = |from: &str, to: &str| match (edge(from), edge(to)) {
            (Some(from), Some(to)) if from < to => [from, to],
            _ => [-1.0, 1.0],
        };
        let steps = |[from, to]: [f64; 2]| {
            (0..=STEPS).map(move |step| from + (to - from) * f64::from(step) / f64::from(STEPS))
        };
        let (along, across) = (seen("from_x", "to_x"), seen("from_y", "to_y"));
        let places =
            || steps(along).flat_map(|x| steps(across).map(move |y| (exponent(factors, x, y), x, y)));
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
        let [coefficients @ .., from_x, to_x, from_y, to_y] = values::<9>(p);
        let inside = |place: f64, from: f64, to: f64| if from < to { place.clamp(from, to) } else { place };
        let place = 2.0 * point_in_world / DVec2::new(field.length_m, field.width_m);
        let (x, y) = (inside(place.x, from_x, to_x), inside(place.y, from_y, to_y));
        exponent(&coefficients, x, y).clamp(-LARGEST_EXPONENT, LARGEST_EXPONENT).exp()
    }
}

/// Returns the logarithm of the light at a position in units of half the field's length and width.
fn exponent(factors: &[f64], x: f64, y: f64) -> f64 {
    let terms = [x, y, x * x, x * y, y * y];
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
