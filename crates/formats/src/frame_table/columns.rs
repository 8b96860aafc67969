//! The columns that every table has.

use super::values::Values;

/// Coordinates of a pose, in the order of covariances.
pub const COVARIANCE_AXES: [&str; 6] = ["x_m", "y_m", "yaw_rad", "height_m", "pitch_rad", "roll_rad"];

/// Kind of a column's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// 64-bit floating point.
    Number,
    /// 64-bit whole number.
    Count,
    /// True or false.
    Flag,
    /// UTF-8 text.
    Text,
}

impl Kind {
    /// Returns a column without values.
    pub(super) fn nulls(self, rows: usize) -> Values {
        match self {
            Self::Number => Values::Numbers(vec![None; rows]),
            Self::Count => Values::Counts(vec![None; rows]),
            Self::Flag => Values::Flags(vec![None; rows]),
            Self::Text => Values::Texts(vec![None; rows]),
        }
    }
}

/// Returns the name of a covariance's column; `a` comes before `b` in [`COVARIANCE_AXES`], or is the same.
pub fn covariance_column(a: &str, b: &str) -> String {
    format!("covariance_{a}_{b}")
}

/// Returns names and kinds of the columns that every table has, in their order. Those of `tag --details` have its names.
pub fn known_columns() -> Vec<(String, Kind)> {
    let numbers = |names: &[&str]| -> Vec<(String, Kind)> {
        names.iter().map(|name| ((*name).to_owned(), Kind::Number)).collect()
    };
    let named = |name: &str, kind| (name.to_owned(), kind);
    let mut columns = vec![named("timestamp_s", Kind::Number), named("sequence", Kind::Text)];
    columns.push(named("image", Kind::Text));
    columns.extend(numbers(&COVARIANCE_AXES));
    columns.extend(COVARIANCE_AXES.map(|axis| (format!("sigma_{axis}"), Kind::Number)));
    for (index, a) in COVARIANCE_AXES.iter().enumerate() {
        columns.extend(COVARIANCE_AXES[index..].iter().map(|b| (covariance_column(a, b), Kind::Number)));
    }
    columns.extend(numbers(&["effective_sample_size"]));
    columns.push(named("particles", Kind::Count));
    columns.extend(numbers(&["line_fraction", "explained_fraction"]));
    columns.push(named("sure", Kind::Flag));
    columns.extend(numbers(&["mirror_probability"]));
    columns.push(named("searched", Kind::Flag));
    columns.extend(numbers(&["lines_within_5px", "lines_within_10px"]));
    columns.push(named("settled", Kind::Flag));
    columns.extend(["lines_seen", "lines_unseen", "lines_unexplained"].map(|name| named(name, Kind::Count)));
    columns.extend(numbers(&["brightness", "sharpness", "error_m", "error_yaw_rad"]));
    columns
}
