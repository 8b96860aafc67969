//! Uneven illumination: lamps light some parts of the field more than others.
//!
//! The light's logarithm is a polynomial of the second degree in the position on the field: a sum of products of Legendre's
//! polynomials over the rectangle in which the light was measured, so that each coefficient is at most what it changes there.
//! Its mean is free, too: brightness that a person read off in one place is not that of the hall. Outside the rectangle, the
//! light is that at the rectangle's edge: a polynomial tells nothing of places that nobody has seen.

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
/// Bound of the exponent, because all coefficients together may be large: light is at least e⁻³ and at most e³ times the nominal
/// one.
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
        Parameter::shape("mean", "1", RANGE, MATERIAL),
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
        // The mean is the same in all places.
        let coefficients = ABOUT.parameters.iter().filter(|parameter| parameter.role == Role::Size);
        let value = |parameter: &Parameter| Some(estimates.get(parameter.name)?.value);
        let factors: Vec<f64> = coefficients.map(value).collect::<Option<_>>()?;
        let factors = &factors;
        let edges = ["from_x", "to_x", "from_y", "to_y"]
            .map(|name| estimates.get(name).map_or(0.0, |edge| edge.value));
        let seen = Seen::new(edges);
        let steps = |[from, to]: [f64; 2]| {
            let [from, to] = [from.clamp(-1.0, 1.0), to.clamp(-1.0, 1.0)];
            (0..=STEPS).map(move |step| from + (to - from) * f64::from(step) / f64::from(STEPS))
        };
        let exponent = |x: f64, y: f64| exponent(factors, seen.place(DVec2::new(x, y)));
        let places = || steps(seen.x).flat_map(|x| steps(seen.y).map(move |y| (x, y)));
        let of_place = |(x, y): (f64, f64)| (exponent(x, y), x, y);
        let brightest = places().map(of_place).max_by(|a, b| a.0.total_cmp(&b.0))?;
        let darkest = places().map(of_place).min_by(|a, b| a.0.total_cmp(&b.0))?;
        // The coefficients' errors are correlated: there is no interval to state.
        Some(format!(
            "the light is brightest {} and darkest {}, by a factor of {}",
            part_of_field(brightest.1, brightest.2),
            part_of_field(darkest.1, darkest.2),
            digits((brightest.0 - darkest.0).exp(), 2)
        ))
    }

    fn light(&self, p: &[f64], point_in_world: DVec2, field: &FieldDimensions) -> f64 {
        let [coefficients @ .., from_x, to_x, from_y, to_y] = values::<10>(p);
        let place = 2.0 * point_in_world / DVec2::new(field.length_m, field.width_m);
        let place = Seen::new([from_x, to_x, from_y, to_y]).place(place);
        exponent(&coefficients, place).clamp(-LARGEST_EXPONENT, LARGEST_EXPONENT).exp()
    }
}

/// Rectangle in which the light was measured, in units of half the field's length and width.
struct Seen {
    x: [f64; 2],
    y: [f64; 2],
}

impl Seen {
    /// Creates the rectangle from its edges; where none is given, it is the field.
    fn new([from_x, to_x, from_y, to_y]: [f64; 4]) -> Self {
        let range = |from: f64, to: f64| if from < to { [from, to] } else { [-1.0, 1.0] };
        Self { x: range(from_x, to_x), y: range(from_y, to_y) }
    }

    /// Returns the nearest place of the rectangle, whose edges are at −1 and 1.
    fn place(&self, place: DVec2) -> DVec2 {
        let of =
            |value: f64, [from, to]: [f64; 2]| (2.0 * (value - from) / (to - from) - 1.0).clamp(-1.0, 1.0);
        DVec2::new(of(place.x, self.x), of(place.y, self.y))
    }
}

/// Returns the logarithm of the light at a place of the rectangle in which it was measured.
fn exponent(factors: &[f64], place: DVec2) -> f64 {
    let ([x, xx], [y, yy]) = (legendre(place.x), legendre(place.y));
    let terms = [x, y, xx, x * y, yy, 1.0];
    factors.iter().zip(terms).map(|(factor, term)| factor * term).sum()
}

/// Returns Legendre's polynomials of the first and the second degree.
fn legendre(x: f64) -> [f64; 2] {
    [x, 1.5 * x * x - 0.5]
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
