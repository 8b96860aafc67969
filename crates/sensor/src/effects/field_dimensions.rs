//! Field dimensions: the field's size differs from the rule book.
//!
//! The values are added to the dimensions and clamped where the field would become invalid.

use reality_sim_core::field::FieldDimensions;

use super::phrases::outstanding;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::{Uncertain, Unit},
};

/// Largest plausible length of a field, metres.
const LARGEST_M: f64 = 200.0;
/// Largest ratio of a length to another that has to exceed it.
const ROOM: f64 = 1.0 - 1e-9;

#[derive(Debug)]
pub(super) struct FieldSize;

const ABOUT: About = About {
    id: "field_dimensions",
    name: "the field is not as large as written down",
    because: "some lines lie beside where they should be, by the same distance on the ground from wherever they are seen",
    opposite: None,
    noun: "a field of another size",
    rank: 90,
    unit: Unit::Centimeters,
    stage: Stage::World,
    parameters: &[
        Parameter::size("length_m", "m", [-1.0, 1.0], 0.005),
        Parameter::size("width_m", "m", [-1.0, 1.0], 0.005),
        Parameter::size("goal_area_length_m", "m", [-1.0, 1.0], 0.005),
        Parameter::size("goal_area_width_m", "m", [-1.0, 1.0], 0.005),
        Parameter::size("center_circle_diameter_m", "m", [-1.0, 1.0], 0.005),
    ],
    covariates: &[Covariate::FieldPosition],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at every line of the field, near ones above all, from several sides",
};

impl Effect for FieldSize {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let parts = [
            ("length_m", "the field is", ["longer", "shorter"]),
            ("width_m", "the field is", ["wider", "narrower"]),
            ("goal_area_length_m", "the goal areas are", ["deeper", "less deep"]),
            ("goal_area_width_m", "the goal areas are", ["wider", "narrower"]),
            ("center_circle_diameter_m", "the centre circle is", ["wider", "narrower"]),
        ];
        let known: Vec<_> = parts
            .into_iter()
            .filter_map(|(name, subject, words)| Some(((subject, words), estimates.get(name)?)))
            .collect();
        let text = |((subject, words), change): ((&str, [&str; 2]), Uncertain)| {
            format!("{subject} {}", change.in_unit(Unit::Centimeters).with_direction(words))
        };
        let texts: Vec<String> = outstanding(&known).into_iter().map(text).collect();
        (!texts.is_empty()).then(|| texts.join(", "))
    }

    fn field(&self, p: &[f64], field: FieldDimensions) -> FieldDimensions {
        let [length_m, width_m, area_length_m, area_width_m, circle_m] = values(p);
        let length_m = (field.length_m + length_m).max(least_length_m(&field)).min(LARGEST_M);
        let width_m = (field.width_m + width_m).max(least_width_m(&field)).min(LARGEST_M);
        FieldDimensions {
            length_m,
            width_m,
            goal_area_length_m: (field.goal_area_length_m + area_length_m).clamp(0.0, ROOM * length_m / 2.0),
            goal_area_width_m: (field.goal_area_width_m + area_width_m).clamp(0.0, width_m),
            center_circle_diameter_m: (field.center_circle_diameter_m + circle_m)
                .clamp(0.0, length_m.min(width_m)),
            ..field
        }
    }
}

/// Returns the shortest length whose halves have room for the marks along the field.
fn least_length_m(field: &FieldDimensions) -> f64 {
    let deepest_m = field.penalty_mark_distance_m.max(field.penalty_area_length_m.unwrap_or(0.0));
    (2.0 * deepest_m / ROOM).max(least_side_m(field))
}

fn least_width_m(field: &FieldDimensions) -> f64 {
    field.goal_width_m.max(field.penalty_area_width_m.unwrap_or(0.0)).max(least_side_m(field))
}

/// Returns the shortest side for which the lines are narrower than a tenth of the field.
fn least_side_m(field: &FieldDimensions) -> f64 {
    (10.0 * field.line_width_m / ROOM).max(0.5)
}
