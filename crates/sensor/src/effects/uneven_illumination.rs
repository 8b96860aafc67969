//! Lamps light some parts of the field more than others.
//!
//! The light's logarithm is a polynomial of the third degree of the place on the field, in units of half the field's
//! length and width, without a constant: that would be the exposure.

use glam::DVec2;
use reality_sim_core::field::FieldDimensions;

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

/// Of every coefficient.
const RANGE: [f64; 2] = [-1.5, 1.5];
/// Two percent of the light at the field's lines.
const MATERIAL: f64 = 0.02;
/// Light is neither more nor less than e³ times the nominal one: far outside the field a cubic has no bounds.
const LARGEST_EXPONENT: f64 = 3.0;

#[derive(Debug)]
pub(super) struct UnevenIllumination;

const ABOUT: About = About {
    id: "uneven_illumination",
    name: "some parts of the field get more light than others",
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
    because: "lines and carpet are brighter in some places of the field, from wherever they are seen",
    recording_that_would_decide: "walk over the whole field and look at each part of it from several sides",
};

impl Effect for UnevenIllumination {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn light(&self, p: &[f64], point_in_world: DVec2, field: &FieldDimensions) -> f64 {
        let DVec2 { x, y } = 2.0 * point_in_world / DVec2::new(field.length_m, field.width_m);
        let terms = [x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y];
        let exponent: f64 = values::<9>(p).iter().zip(terms).map(|(factor, term)| factor * term).sum();
        exponent.clamp(-LARGEST_EXPONENT, LARGEST_EXPONENT).exp()
    }
}
