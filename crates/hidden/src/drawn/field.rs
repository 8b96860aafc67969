//! Fields of several leagues, each a little off the rules as halls are.

use reality_sim_core::field::FieldDimensions;

use crate::{
    nominal::{kid_size_field, rounded},
    random::Random,
};

/// Dimensions are multiples of a centimetre.
const PER_M: f64 = 100.0;
/// Largest deviation of a length from the rules, as a fraction.
const SPREAD: f64 = 0.04;

/// Draws a field.
pub fn draw(random: &mut Random) -> FieldDimensions {
    let (rules, line_m) = match random.below(4) {
        0 => (kid_size_field(), random.between(0.045, 0.06)),
        1 => (standard_platform_field(), random.between(0.045, 0.06)),
        2 => (large_kid_size_field(), random.between(0.045, 0.06)),
        _ => (adult_size_field(), random.between(0.05, 0.08)),
    };
    let mut near = |value: f64| rounded(value * random.between(1.0 - SPREAD, 1.0 + SPREAD), PER_M);
    FieldDimensions {
        name: "drawn".to_owned(),
        length_m: near(rules.length_m),
        width_m: near(rules.width_m),
        line_width_m: rounded(line_m, 1e3),
        border_strip_m: near(rules.border_strip_m),
        goal_area_length_m: near(rules.goal_area_length_m),
        goal_area_width_m: near(rules.goal_area_width_m),
        penalty_mark_distance_m: near(rules.penalty_mark_distance_m),
        center_circle_diameter_m: near(rules.center_circle_diameter_m),
        goal_width_m: near(rules.goal_width_m),
        goal_height_m: near(rules.goal_height_m),
        penalty_area_length_m: rules.penalty_area_length_m.map(&mut near),
        penalty_area_width_m: rules.penalty_area_width_m.map(&mut near),
        ..rules
    }
}

/// Returns the field of another league, whose length differs by a sixth and more.
pub fn another_league(field: &FieldDimensions) -> FieldDimensions {
    let differs = |other: &FieldDimensions| (other.length_m / field.length_m).ln().abs() > 0.15;
    let all = [standard_platform_field(), adult_size_field()];
    all.into_iter().find(differs).unwrap_or_else(kid_size_field)
}

/// Field of 9 × 6 m of the Standard Platform League.
fn standard_platform_field() -> FieldDimensions {
    FieldDimensions {
        name: "standard-platform".to_owned(),
        length_m: 9.0,
        width_m: 6.0,
        border_strip_m: 0.7,
        penalty_mark_distance_m: 1.3,
        center_circle_diameter_m: 1.5,
        penalty_area_length_m: Some(1.65),
        penalty_area_width_m: Some(4.0),
        ..kid_size_field()
    }
}

/// Field of 9 × 6 m of the Humanoid League.
fn large_kid_size_field() -> FieldDimensions {
    FieldDimensions {
        name: "humanoid-kidsize".to_owned(),
        length_m: 9.0,
        width_m: 6.0,
        border_strip_m: 1.0,
        goal_area_length_m: 1.0,
        goal_area_width_m: 3.0,
        penalty_mark_distance_m: 1.5,
        center_circle_diameter_m: 1.5,
        goal_width_m: 2.6,
        goal_height_m: 1.2,
        penalty_area_length_m: Some(2.0),
        penalty_area_width_m: Some(5.0),
        ..kid_size_field()
    }
}

/// Field of 14 × 9 m of the Humanoid League.
fn adult_size_field() -> FieldDimensions {
    FieldDimensions {
        name: "humanoid-adultsize".to_owned(),
        length_m: 14.0,
        width_m: 9.0,
        border_strip_m: 1.0,
        goal_area_length_m: 1.0,
        goal_area_width_m: 4.0,
        penalty_mark_distance_m: 2.1,
        center_circle_diameter_m: 3.0,
        goal_width_m: 2.6,
        goal_height_m: 1.8,
        goal_post_diameter_m: 0.12,
        penalty_area_length_m: Some(3.0),
        penalty_area_width_m: Some(6.0),
        ..kid_size_field()
    }
}
