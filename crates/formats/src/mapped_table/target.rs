//! What a column of a table can be, and its units.

use serde::Deserialize;

/// Value of a recording that a column gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
pub(super) enum Target {
    #[serde(rename = "timestamp_s")]
    Timestamp,
    #[serde(rename = "image")]
    Image,
    #[serde(rename = "odometry_x_m")]
    OdometryX,
    #[serde(rename = "odometry_y_m")]
    OdometryY,
    #[serde(rename = "odometry_yaw_rad")]
    OdometryYaw,
    #[serde(rename = "pitch_rad")]
    Pitch,
    #[serde(rename = "roll_rad")]
    Roll,
    #[serde(rename = "reference_x_m")]
    ReferenceX,
    #[serde(rename = "reference_y_m")]
    ReferenceY,
    #[serde(rename = "reference_yaw_rad")]
    ReferenceYaw,
    #[serde(rename = "reference_height_m")]
    ReferenceHeight,
    #[serde(rename = "reference_pitch_rad")]
    ReferencePitch,
    #[serde(rename = "reference_roll_rad")]
    ReferenceRoll,
}

/// Kind of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Length,
    Angle,
}

impl Target {
    /// Returns the name in mapping files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Timestamp => "timestamp_s",
            Self::Image => "image",
            Self::OdometryX => "odometry_x_m",
            Self::OdometryY => "odometry_y_m",
            Self::OdometryYaw => "odometry_yaw_rad",
            Self::Pitch => "pitch_rad",
            Self::Roll => "roll_rad",
            Self::ReferenceX => "reference_x_m",
            Self::ReferenceY => "reference_y_m",
            Self::ReferenceYaw => "reference_yaw_rad",
            Self::ReferenceHeight => "reference_height_m",
            Self::ReferencePitch => "reference_pitch_rad",
            Self::ReferenceRoll => "reference_roll_rad",
        }
    }

    /// Returns the kind of number; `None` for a file name.
    pub fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Timestamp => Some(Quantity::Time),
            Self::Image => None,
            Self::OdometryX
            | Self::OdometryY
            | Self::ReferenceX
            | Self::ReferenceY
            | Self::ReferenceHeight => Some(Quantity::Length),
            Self::OdometryYaw
            | Self::Pitch
            | Self::Roll
            | Self::ReferenceYaw
            | Self::ReferencePitch
            | Self::ReferenceRoll => Some(Quantity::Angle),
        }
    }
}

/// Unit of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(super) enum Unit {
    #[serde(rename = "s")]
    Seconds,
    #[serde(rename = "ms")]
    Milliseconds,
    #[serde(rename = "us")]
    Microseconds,
    #[serde(rename = "ns")]
    Nanoseconds,
    #[serde(rename = "m")]
    Metres,
    #[serde(rename = "cm")]
    Centimetres,
    #[serde(rename = "mm")]
    Millimetres,
    #[serde(rename = "rad")]
    Radians,
    #[serde(rename = "deg")]
    Degrees,
}

impl Unit {
    /// Returns what it measures.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Seconds | Self::Milliseconds | Self::Microseconds | Self::Nanoseconds => Quantity::Time,
            Self::Metres | Self::Centimetres | Self::Millimetres => Quantity::Length,
            Self::Radians | Self::Degrees => Quantity::Angle,
        }
    }

    /// Returns seconds, metres or radians of a number in this unit. Divides by whole numbers, which are exact.
    pub fn to_si(self, value: f64) -> f64 {
        match self {
            Self::Seconds | Self::Metres | Self::Radians => value,
            Self::Milliseconds | Self::Millimetres => value / 1e3,
            Self::Microseconds => value / 1e6,
            Self::Nanoseconds => value / 1e9,
            Self::Centimetres => value / 1e2,
            Self::Degrees => value.to_radians(),
        }
    }
}
