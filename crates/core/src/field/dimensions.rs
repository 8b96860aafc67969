//! Dimensions of a field, as `field.toml` holds them.

use serde::{Deserialize, Serialize};

/// Plausible sizes of a field; others are a mistake in the file: the largest league field is 22 m long.
const PLAUSIBLE_LENGTH_M: std::ops::RangeInclusive<f64> = 0.5..=200.0;

/// Dimensions of a field, metres. Lengths between lines are measured between the lines' centres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FieldDimensions {
    /// Name of the field.
    #[serde(default)]
    pub name: String,
    /// Distance from goal line to goal line, along x.
    pub length_m: f64,
    /// Distance from touch line to touch line, along y.
    pub width_m: f64,
    /// Width of the white lines.
    pub line_width_m: f64,
    /// Width of the carpet outside the outermost lines.
    pub border_strip_m: f64,
    /// Depth of the goal area, along x.
    pub goal_area_length_m: f64,
    /// Width of the goal area, along y.
    pub goal_area_width_m: f64,
    /// Distance from the goal line to the penalty mark.
    pub penalty_mark_distance_m: f64,
    /// Diameter of the centre circle.
    pub center_circle_diameter_m: f64,
    /// Distance between the inner sides of the posts.
    pub goal_width_m: f64,
    /// Height from the carpet to the lower side of the crossbar.
    pub goal_height_m: f64,
    /// Diameter of posts and crossbar.
    pub goal_post_diameter_m: f64,
    /// Depth of the penalty area, along x, if the field has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penalty_area_length_m: Option<f64>,
    /// Width of the penalty area, along y, if the field has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub penalty_area_width_m: Option<f64>,
    /// Colour of the goal at +x in sRGB (0–255), if the two goals differ in colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_srgb_positive_x: Option<[u8; 3]>,
    /// Colour of the goal at −x in sRGB (0–255), if the two goals differ in colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_srgb_negative_x: Option<[u8; 3]>,
}

/// Dimension that contradicts the others or is impossible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{name} is {value}: {rule}")]
pub struct InvalidField {
    /// Key in `field.toml`.
    pub name: &'static str,
    /// Given value.
    pub value: f64,
    /// Rule that the value has to fulfil.
    pub rule: &'static str,
}

impl FieldDimensions {
    /// Checks that the dimensions describe a field on which lines can be drawn. Fails with the first dimension that
    /// breaks a rule.
    pub fn validate(&self) -> Result<(), InvalidField> {
        self.check_outline()?;
        let Self { goal_area_length_m, goal_area_width_m, penalty_mark_distance_m, .. } = *self;
        self.check_along("goal_area_length_m", goal_area_length_m)?;
        self.check_across("goal_area_width_m", goal_area_width_m)?;
        self.check_along("penalty_mark_distance_m", penalty_mark_distance_m)?;
        let diameter_m = self.center_circle_diameter_m;
        let is_valid = diameter_m >= 0.0 && diameter_m <= self.length_m.min(self.width_m);
        check("center_circle_diameter_m", diameter_m, is_valid, "must be 0 or more and fit into the field")?;
        self.check_across("goal_width_m", self.goal_width_m)?;
        for (name, value) in
            [("goal_height_m", self.goal_height_m), ("goal_post_diameter_m", self.goal_post_diameter_m)]
        {
            check(name, value, (0.0..=10.0).contains(&value), "must be between 0 and 10 metres")?;
        }
        self.check_penalty_area()
    }

    /// Checks length, width, and what lies along the whole outline.
    fn check_outline(&self) -> Result<(), InvalidField> {
        for (name, value) in [("length_m", self.length_m), ("width_m", self.width_m)] {
            check(name, value, PLAUSIBLE_LENGTH_M.contains(&value), "must be between 0.5 and 200 metres")?;
        }
        let (line_m, shorter_m) = (self.line_width_m, self.length_m.min(self.width_m));
        let is_valid = line_m > 0.0 && line_m < shorter_m / 10.0;
        check("line_width_m", line_m, is_valid, "must be above 0 and below a tenth of the field")?;
        let strip_m = self.border_strip_m;
        check("border_strip_m", strip_m, (0.0..=20.0).contains(&strip_m), "must be between 0 and 20 metres")
    }

    fn check_penalty_area(&self) -> Result<(), InvalidField> {
        match (self.penalty_area_length_m, self.penalty_area_width_m) {
            (None, None) => Ok(()),
            (Some(length_m), Some(width_m)) => {
                self.check_along("penalty_area_length_m", length_m)?;
                self.check_across("penalty_area_width_m", width_m)
            }
            (Some(value), None) => {
                check("penalty_area_length_m", value, false, "needs penalty_area_width_m beside it")
            }
            (None, Some(value)) => {
                check("penalty_area_width_m", value, false, "needs penalty_area_length_m beside it")
            }
        }
    }

    /// Checks a length that is measured from a goal line into the field.
    fn check_along(&self, name: &'static str, value: f64) -> Result<(), InvalidField> {
        let is_valid = value >= 0.0 && value < self.length_m / 2.0;
        check(name, value, is_valid, "must be 0 or more and below half the field's length")
    }

    /// Checks a length along a goal line.
    fn check_across(&self, name: &'static str, value: f64) -> Result<(), InvalidField> {
        let is_valid = value >= 0.0 && value <= self.width_m;
        check(name, value, is_valid, "must be 0 or more and at most the field's width")
    }

    /// Returns half the carpet's extent along x and y, including lines and border strip, metres.
    pub fn carpet_half_extent_m(&self) -> glam::DVec2 {
        glam::DVec2::new(self.length_m, self.width_m) / 2.0 + self.border_strip_m + self.line_width_m / 2.0
    }
}

fn check(name: &'static str, value: f64, is_valid: bool, rule: &'static str) -> Result<(), InvalidField> {
    if value.is_finite() && is_valid { Ok(()) } else { Err(InvalidField { name, value, rule }) }
}
