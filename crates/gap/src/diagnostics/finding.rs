//! Findings that no effect of the library explains, as numbers.

use serde::{Deserialize, Serialize};

use crate::{
    diagnostics::input_mistake::InputMistake,
    measurement::quantity::{Channel, ColorChannel},
};

/// Significant deviation that no effect of the library explains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Finding {
    /// File of the recording that seems to be meant in another way than it is read.
    InputMistake {
        /// The mistake.
        mistake: InputMistake,
    },
    /// Pictures without any white line.
    NoLines,
    /// Most white lines of the pictures are not those of the field, or not where the poses see these.
    ForeignLines {
        /// Share of the white pixels on the ground that lie beside every line of the field, 0 to 1.
        share: f64,
        /// Share of the pieces of line in view that are not found, 0 to 1.
        missed: f64,
    },
    /// Residuals with the same mean in every part of the recording.
    Pattern {
        /// Channel of the residuals.
        channel: Channel,
        /// Cell in which the mean is strongest.
        strongest: PatternCell,
        /// Size of the mean, in the channel's unit.
        size: f64,
        /// P-value of the mean in the strongest cell, corrected for all cells of all patterns.
        p_value: f64,
    },
    /// Bands of brightness along the rows that differ from picture to picture, as flickering lamps cause them.
    Flicker {
        /// Root mean square of the bands, natural logarithm of light.
        size: f64,
        /// P-value of the bands.
        p_value: f64,
    },
    /// Carpet that is hidden in the same place of nearly every picture, wherever the camera looks: something on the lens or in
    /// front of it.
    Obstruction {
        /// Share of the carpet in view that is hidden, 0 to 1.
        share: f64,
        /// Column of its middle in a grid over the picture, from the left.
        column: usize,
        /// Row of its middle, from the top.
        row: usize,
        /// Number of columns and rows.
        grid: [usize; 2],
    },
    /// Line of the field that the pictures do not show where the model predicts it.
    MissingLine {
        /// Missing line.
        line: FieldLine,
        /// Share of its pieces that were found, 0 to 1.
        found_share: f64,
        /// Share that is found of other lines that are as wide in the picture.
        usual_share: f64,
    },
    /// Residuals of the odometry that are proportional to the robot's movement.
    Odometry {
        /// Component of the odometry's steps.
        component: OdometryComponent,
        /// Movement that its residuals are proportional to.
        follows: Movement,
        /// Root mean square of the proportional part, metres or radians.
        size: f64,
    },
    /// Nominal value of the camera file that would have to be farther off than its tolerance.
    NominalValue {
        /// Nominal value that is farthest off.
        value: NominalValue,
        /// Deviation: a fraction of the value, or pixels squared.
        off_by: f64,
        /// P-value of the deviations of all nominal values of the channel together.
        p_value: f64,
    },
    /// Lines that the pictures do not show where the model predicts them, although the poses are refitted.
    UnexplainedLines {
        /// Share of the lines' pieces in held-out frames, 0 to 1.
        share: f64,
    },
    /// Residuals far above the noise floor that form no pattern: they differ from picture to picture.
    Scatter {
        /// Channel of the residuals.
        channel: Channel,
        /// Root mean square of the residuals, in the channel's unit.
        size: f64,
        /// Noise floor, in the channel's unit.
        floor: f64,
    },
}

/// Cell in which the mean of a pattern is strongest.
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
        /// Centre along the field (world x), metres.
        x_m: f64,
        /// Centre across the field (world y), metres.
        y_m: f64,
    },
    /// Interval of time.
    Time {
        /// Start of the interval, seconds after the first frame.
        after_s: f64,
    },
    /// Interval of speeds at which a line moves across itself in the picture.
    Speed {
        /// Middle of the interval, picture widths per second.
        widths_per_s: f64,
    },
}

/// Line of the field.
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

/// Movement that residuals of the odometry may be proportional to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Movement {
    /// Distance that the robot walks forward.
    Ahead,
    /// Angle by which the robot turns.
    Turn,
    /// Time that passes.
    Time,
}

/// Nominal value of the camera file, or a value that follows from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NominalValue {
    /// Level of lines in one colour.
    LineLevel(ColorChannel),
    /// Level of carpet in one colour.
    CarpetLevel(ColorChannel),
    /// Variance of the blur.
    Blur,
    /// Difference of the blur's variance between broad and thin lines.
    BlurByWidth,
    /// Shape of the blur.
    BlurShape,
    /// Variance of the noise.
    NoiseVariance,
}

impl Finding {
    /// Returns the channel of the residuals in which the deviation was found.
    pub fn channel(&self) -> Channel {
        match self {
            Self::Pattern { channel, .. } | Self::Scatter { channel, .. } => *channel,
            Self::Flicker { .. } | Self::Obstruction { .. } => Channel::Photometry,
            Self::MissingLine { .. }
            | Self::UnexplainedLines { .. }
            | Self::InputMistake { .. }
            | Self::NoLines
            | Self::ForeignLines { .. } => Channel::Geometry,
            Self::Odometry { .. } => Channel::Motion,
            Self::NominalValue { value, .. } => value.channel(),
        }
    }

    /// Returns the size in [`Finding::unit`]; for a missing line, the share of it that is missing.
    pub fn size(&self) -> f64 {
        match self {
            Self::Pattern { size, .. }
            | Self::Flicker { size, .. }
            | Self::Odometry { size, .. }
            | Self::Scatter { size, .. } => *size,
            Self::Obstruction { share, .. }
            | Self::UnexplainedLines { share }
            | Self::ForeignLines { share, .. } => *share,
            Self::MissingLine { found_share, usual_share, .. } => 1.0 - found_share / usual_share,
            Self::NominalValue { off_by, .. } => *off_by,
            Self::InputMistake { .. } | Self::NoLines => 1.0,
        }
    }

    /// Returns the unit of the size: `1` for a plain number.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Pattern { channel, .. } | Self::Scatter { channel, .. } => channel.unit(),
            Self::Flicker { .. }
            | Self::Obstruction { .. }
            | Self::MissingLine { .. }
            | Self::UnexplainedLines { .. }
            | Self::InputMistake { .. }
            | Self::NoLines
            | Self::ForeignLines { .. } => "1",
            Self::Odometry { component, .. } => component.unit(),
            Self::NominalValue { value, .. } => value.unit(),
        }
    }

    /// Whether the finding is about the recording's files, so that nothing else can be said of the recording.
    pub fn stops_the_analysis(&self) -> bool {
        matches!(self, Self::InputMistake { .. } | Self::NoLines | Self::ForeignLines { .. })
    }

    /// Returns the p-value; `None` for findings that are counted and not tested.
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
    /// Returns the channel whose residuals depend on the value.
    pub fn channel(self) -> Channel {
        match self {
            Self::LineLevel(_) | Self::CarpetLevel(_) => Channel::Photometry,
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
