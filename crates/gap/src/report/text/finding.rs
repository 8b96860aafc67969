//! Findings that no effect explains, in words.

use reality_sim_sensor::text::{percent, rounded};

use super::{
    input_mistake::input_mistake,
    number::amount,
    place::{field_place, picture_place},
};
use crate::{
    diagnostics::finding::{FieldLine, Finding, Movement, NominalValue, OdometryComponent, PatternCell},
    measurement::quantity::ColorChannel,
};

/// Returns where a finding shows, and as what: "in the picture, strongest left of the middle, in the lower part".
pub fn finding_place(finding: &Finding) -> String {
    match finding {
        Finding::InputMistake { mistake } => input_mistake(*mistake),
        Finding::NoLines => {
            "no picture shows a white line where the field's lines should be, or anywhere: check that the \
                             pictures are those of this recording, and their exposure"
                .to_owned()
        }
        Finding::ForeignLines { share, missed } => foreign_lines(*share, *missed),
        Finding::Pattern { strongest, .. } => pattern(*strongest),
        Finding::Flicker { .. } => {
            "bands along the rows that differ from picture to picture, as of lamps that flicker".to_owned()
        }
        Finding::Obstruction { share, column, row, grid } => format!(
            "{} of the carpet in view is hidden {} of nearly every picture, wherever the camera looks",
            percent(*share),
            picture_place([*column, *row], *grid)
        ),
        Finding::MissingLine { line, found_share, usual_share } => format!(
            "{}: found in {} of the places where it should be, other lines as wide in {}",
            field_line(*line),
            percent(*found_share),
            percent(*usual_share)
        ),
        Finding::Odometry { component, follows, .. } => {
            format!("in its {}, {}", steps(*component), following(*follows))
        }
        Finding::NominalValue { value, .. } => format!(
            "in all pictures, most of all {}: farther from the value in camera.toml than its tolerance allows",
            nominal_value(*value)
        ),
        Finding::UnexplainedLines { share } => {
            format!("{} of the lines are not where they should be", percent(*share))
        }
        Finding::Scatter { .. } => {
            "differently in each picture, by more than noise and errors of the poses cause".to_owned()
        }
    }
}

/// Returns a finding's size with its unit: "0.13 px²", "7.4 %".
pub fn finding_size(finding: &Finding) -> String {
    amount(finding.channel(), finding.size(), finding.unit(), 2)
}

/// Whether the words of [`finding_place`] already state the finding's size.
pub(super) fn place_has_size(finding: &Finding) -> bool {
    matches!(
        finding,
        Finding::Obstruction { .. }
            | Finding::MissingLine { .. }
            | Finding::UnexplainedLines { .. }
            | Finding::InputMistake { .. }
            | Finding::NoLines
            | Finding::ForeignLines { .. }
    )
}

/// Returns how many lines do not belong to the field, and what to check.
fn foreign_lines(share: f64, missed: f64) -> String {
    format!(
        "{} of the white lines in the pictures are no lines of the field in field.toml as the poses see it, and {} of the \
         lines that should be there are not found: field.toml, camera.toml or the poses do not belong to these pictures",
        percent(share),
        percent(missed)
    )
}

/// Returns where a pattern is strongest.
fn pattern(strongest: PatternCell) -> String {
    match strongest {
        PatternCell::Picture { column, row, grid } => {
            format!("in the picture, strongest {}", picture_place([column, row], grid))
        }
        PatternCell::Field { x_m, y_m } => format!("on the field, strongest {}", field_place(x_m, y_m)),
        PatternCell::Time { after_s } => {
            format!("over time, strongest {} s after the start", rounded(after_s, 0))
        }
        PatternCell::Speed { widths_per_s } => {
            format!("as the picture moves, strongest where it moves by {widths_per_s:.2} widths a second")
        }
    }
}

fn field_line(line: FieldLine) -> String {
    match line {
        FieldLine::Segment { from_m, to_m } => {
            format!(
                "the line from ({:.1}, {:.1}) m to ({:.1}, {:.1}) m",
                from_m[0], from_m[1], to_m[0], to_m[1]
            )
        }
        FieldLine::Circle { diameter_m } => format!("the circle of {diameter_m:.1} m"),
    }
}

fn steps(component: OdometryComponent) -> &'static str {
    match component {
        OdometryComponent::Forward => "steps forward",
        OdometryComponent::Left => "steps to the left",
        OdometryComponent::Turn => "turns",
    }
}

fn following(movement: Movement) -> &'static str {
    match movement {
        Movement::Ahead => "as the robot walks ahead",
        Movement::Turn => "as it turns",
        Movement::Time => "as time goes by",
    }
}

fn nominal_value(value: NominalValue) -> String {
    match value {
        NominalValue::LineLevel(color) => format!("{} of lines", color_name(color)),
        NominalValue::CarpetLevel(color) => format!("{} of carpet", color_name(color)),
        NominalValue::Blur => "the blur".to_owned(),
        NominalValue::BlurByWidth => "the blur of broad lines against thin ones".to_owned(),
        NominalValue::BlurShape => "the shape of the blur".to_owned(),
        NominalValue::NoiseVariance => "its variance".to_owned(),
    }
}

fn color_name(color: ColorChannel) -> &'static str {
    match color {
        ColorChannel::Red => "red",
        ColorChannel::Green => "green",
        ColorChannel::Blue => "blue",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::quantity::Channel;

    fn pattern_in(strongest: PatternCell) -> Finding {
        Finding::Pattern { channel: Channel::Sharpness, strongest, size: 0.131, p_value: 1e-6 }
    }

    fn assert_said(cases: &[(Finding, &str, &str)]) {
        for (finding, place, size) in cases {
            assert_eq!((finding_place(finding).as_str(), finding_size(finding).as_str()), (*place, *size));
        }
    }

    #[test]
    fn a_pattern_is_described_by_its_place_and_size() {
        let picture = PatternCell::Picture { column: 2, row: 4, grid: [8, 6] };
        assert_said(&[
            (
                pattern_in(picture),
                "in the picture, strongest left of the middle, in the lower part",
                "0.13 px²",
            ),
            (
                pattern_in(PatternCell::Field { x_m: 1.5, y_m: -0.5 }),
                "on the field, strongest around x = 1.5 m, y = −0.5 m",
                "0.13 px²",
            ),
            (
                pattern_in(PatternCell::Time { after_s: 3.0 }),
                "over time, strongest 3 s after the start",
                "0.13 px²",
            ),
            (
                pattern_in(PatternCell::Speed { widths_per_s: 0.25 }),
                "as the picture moves, strongest where it moves by 0.25 widths a second",
                "0.13 px²",
            ),
        ]);
    }

    #[test]
    fn every_other_finding_is_described_by_its_place_and_size() {
        let line = FieldLine::Segment { from_m: [-4.5, 3.0], to_m: [4.5, 3.0] };
        let nominal = |value, off_by| Finding::NominalValue { value, off_by, p_value: 1e-3 };
        let odometry = |component| Finding::Odometry { component, follows: Movement::Turn, size: 0.0123 };
        assert_said(&[
            (
                Finding::Flicker { size: 0.074, p_value: 1e-4 },
                "bands along the rows that differ from picture to picture, as of lamps that flicker",
                "7.4 %",
            ),
            (
                Finding::Obstruction { share: 0.124, column: 0, row: 4, grid: [8, 6] },
                "12 % of the carpet in view is hidden at the left edge, in the lower part of nearly every picture, wherever \
                 the camera looks",
                "12 %",
            ),
            (
                Finding::MissingLine { line, found_share: 0.1, usual_share: 0.8 },
                "the line from (-4.5, 3.0) m to (4.5, 3.0) m: found in 10 % of the places where it should be, other \
                 lines as wide in 80 %",
                "0.88",
            ),
            (
                Finding::MissingLine {
                    line: FieldLine::Circle { diameter_m: 1.5 },
                    found_share: 0.0,
                    usual_share: 0.8,
                },
                "the circle of 1.5 m: found in 0 % of the places where it should be, other lines as wide in 80 %",
                "1.0",
            ),
            (odometry(OdometryComponent::Left), "in its steps to the left, as it turns", "0.012 m"),
            (odometry(OdometryComponent::Turn), "in its turns, as it turns", "0.012 rad"),
            (
                nominal(NominalValue::CarpetLevel(ColorChannel::Red), 0.42),
                "in all pictures, most of all red of carpet: farther from the value in camera.toml than its tolerance allows",
                "42 %",
            ),
            (
                nominal(NominalValue::Blur, 0.2),
                "in all pictures, most of all the blur: farther from the value in camera.toml than its tolerance allows",
                "0.20 px²",
            ),
            (
                Finding::UnexplainedLines { share: 0.39 },
                "39 % of the lines are not where they should be",
                "0.39",
            ),
            (
                Finding::Scatter { channel: Channel::Geometry, size: 1.4, floor: 0.5 },
                "differently in each picture, by more than noise and errors of the poses cause",
                "1.4 px",
            ),
        ]);
    }
}
