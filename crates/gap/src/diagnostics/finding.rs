//! What no effect of the library explains, as numbers.

use serde::{Deserialize, Serialize};

use crate::measurement::quantity::{Channel, ColorChannel};

/// Something significant that no effect explains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Finding {
    /// Residuals that keep their mean from one part of the recording to the others.
    Pattern {
        /// Channel of the residuals.
        channel: Channel,
        /// Cell in which the mean is strongest.
        strongest: PatternCell,
        /// Size of the mean, in the channel's unit.
        size: f64,
        /// How unlikely the mean in the strongest cell is chance, corrected for all cells of all patterns.
        p_value: f64,
    },
    /// Bands of brightness along the rows that differ from picture to picture, as flickering lamps make them.
    Flicker {
        /// Root mean square of the bands, natural logarithm of light.
        size: f64,
        /// How unlikely it is chance.
        p_value: f64,
    },
    /// Objects in front of the carpet that the model does not have.
    Occluders {
        /// Share of the carpet in view that they hide.
        share: f64,
    },
    /// Objects on the carpet that are not where they were in other pictures.
    DynamicObjects {
        /// Share of the pictures that show one.
        share: f64,
    },
    /// A line of the field that is not where the model has it.
    MissingLine {
        /// Line that is missing.
        line: FieldLine,
        /// Share of its pieces that were found.
        found_share: f64,
        /// Share that would be usual: that of other lines as wide in the picture.
        usual_share: f64,
    },
    /// Residuals of the odometry that follow the robot's movement.
    Odometry {
        /// Component of the odometry's steps.
        component: OdometryComponent,
        /// What its residuals follow.
        follows: Movement,
        /// Root mean square of the part that follows, metres or radians.
        size: f64,
    },
    /// A nominal value of the camera's file that would have to be farther off than it is trusted.
    NominalValue {
        /// The one that is farthest off.
        value: NominalValue,
        /// By how much: a part of the value, or pixels squared.
        off_by: f64,
        /// How unlikely it is chance that all nominal values of the channel are as far off as they are.
        p_value: f64,
    },
    /// Residuals far above the noise floor and in no pattern: each picture is off in its own way.
    Scatter {
        /// Channel of the residuals.
        channel: Channel,
        /// Root mean square of the residuals, in the channel's unit.
        size: f64,
        /// Noise floor, in the channel's unit.
        floor: f64,
    },
}

/// Cell in which a pattern is strongest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "place", rename_all = "snake_case")]
pub enum PatternCell {
    /// Cell of a grid over the picture.
    Picture {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
        /// Number of columns and rows.
        grid: [usize; 2],
    },
    /// Square of the field.
    Field {
        /// Middle, world axes, metres.
        x_m: f64,
        /// Middle, world axes, metres.
        y_m: f64,
    },
    /// Interval of time.
    Time {
        /// Its beginning after the first frame, seconds.
        after_s: f64,
    },
    /// Interval of the speed with which the picture moves across a line.
    Speed {
        /// Its middle, widths of the picture a second.
        widths_per_s: f64,
    },
}

/// A line of the field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FieldLine {
    /// Straight line.
    Segment {
        /// One end, world axes, metres.
        from_m: [f64; 2],
        /// Other end, world axes, metres.
        to_m: [f64; 2],
    },
    /// Circle.
    Circle {
        /// Diameter, metres.
        diameter_m: f64,
    },
}

/// Component of a step of the odometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OdometryComponent {
    /// Distance forward, metres.
    Forward,
    /// Distance to the left, metres.
    Left,
    /// Turn to the left, radians.
    Turn,
}

/// What residuals of the odometry may follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Movement {
    /// Distance that the robot walks ahead.
    Ahead,
    /// Angle by which it turns.
    Turn,
    /// Time that goes by.
    Time,
}

/// A nominal value of the camera's file, or one that follows from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NominalValue {
    /// Brightness of lines in a colour.
    LineLevel(ColorChannel),
    /// Brightness of carpet in a colour.
    CarpetLevel(ColorChannel),
    /// Brightness of carpet that is seen at a grazing angle.
    Sheen,
    /// Variance of the blur.
    Blur,
    /// Variance of the blur on broad lines against that on thin ones.
    BlurByWidth,
    /// Shape of the blur.
    BlurShape,
    /// Variance of the noise.
    NoiseVariance,
}

impl Finding {
    /// Returns the channel in which it shows.
    pub fn channel(&self) -> Channel {
        match self {
            Self::Pattern { channel, .. } | Self::Scatter { channel, .. } => *channel,
            Self::Flicker { .. } | Self::Occluders { .. } | Self::DynamicObjects { .. } => {
                Channel::Photometry
            }
            Self::MissingLine { .. } => Channel::Geometry,
            Self::Odometry { .. } => Channel::Motion,
            Self::NominalValue { value, .. } => value.channel(),
        }
    }

    /// Returns its size in [`Finding::unit`]. That of a missing line is the share of it that is missing.
    pub fn size(&self) -> f64 {
        match self {
            Self::Pattern { size, .. }
            | Self::Flicker { size, .. }
            | Self::Odometry { size, .. }
            | Self::Scatter { size, .. } => *size,
            Self::Occluders { share } | Self::DynamicObjects { share } => *share,
            Self::MissingLine { found_share, usual_share, .. } => 1.0 - found_share / usual_share,
            Self::NominalValue { off_by, .. } => *off_by,
        }
    }

    /// Returns the unit of its size: `1` for a plain number.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Pattern { channel, .. } | Self::Scatter { channel, .. } => channel.unit(),
            Self::Flicker { .. }
            | Self::Occluders { .. }
            | Self::DynamicObjects { .. }
            | Self::MissingLine { .. } => "1",
            Self::Odometry { component, .. } => component.unit(),
            Self::NominalValue { value, .. } => value.unit(),
        }
    }

    /// Returns how unlikely it is chance; `None` for what is counted and not tested.
    pub fn p_value(&self) -> Option<f64> {
        match self {
            Self::Pattern { p_value, .. }
            | Self::Flicker { p_value, .. }
            | Self::NominalValue { p_value, .. } => Some(*p_value),
            _ => None,
        }
    }
}

impl OdometryComponent {
    fn unit(self) -> &'static str {
        match self {
            Self::Forward | Self::Left => "m",
            Self::Turn => "rad",
        }
    }
}

impl NominalValue {
    /// Returns the channel whose residuals depend on it.
    pub fn channel(self) -> Channel {
        match self {
            Self::LineLevel(_) | Self::CarpetLevel(_) | Self::Sheen => Channel::Photometry,
            Self::Blur | Self::BlurByWidth | Self::BlurShape => Channel::Sharpness,
            Self::NoiseVariance => Channel::Noise,
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Blur | Self::BlurByWidth => "px2",
            _ => "1",
        }
    }
}
