//! Quantities that are measured and compared with a model.

use reality_sim_sensor::Surface;
use serde::{Deserialize, Serialize};

/// Group of quantities that reports combine. Maps by channel are in the order of the channels' names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Offset of red and blue against luma along a line's normal, pixels.
    Color,
    /// Offset of white lines along their normal, pixels.
    Geometry,
    /// Increments of the odometry, forward and left in metres, turn in radians; pitch and roll by joints and IMU, radians.
    Motion,
    /// Natural logarithm of the variance of luma on plain carpet.
    Noise,
    /// Natural logarithm of the linear values of lines and carpet, for each colour.
    Photometry,
    /// Variance of the blur across a line, pixels squared.
    Sharpness,
}

impl Channel {
    /// All channels, from the most to the least informative.
    pub const ALL: [Self; 6] =
        [Self::Geometry, Self::Photometry, Self::Sharpness, Self::Color, Self::Noise, Self::Motion];

    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Photometry => "photometry",
            Self::Sharpness => "sharpness",
            Self::Color => "color",
            Self::Noise => "noise",
            Self::Motion => "motion",
        }
    }

    /// Returns the unit of the residuals.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Geometry | Self::Color => "px",
            Self::Sharpness => "px2",
            Self::Photometry | Self::Noise => "1",
            Self::Motion => "m or rad",
        }
    }
}

/// Colour channel of a picture, in the order in which pixels store them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColorChannel {
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
}

/// Measured quantity. Measurements of one quantity share a unit and a standard deviation.
///
/// Sums over quantities run in the order of the variants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Quantity {
    /// Offset of a line's middle along its normal, in luma, pixels.
    LineOffset,
    /// Natural logarithm of the linear value on a line's inner part.
    LineLevel(ColorChannel),
    /// Natural logarithm of the mean linear value of a block of carpet.
    CarpetLevel(ColorChannel),
    /// Variance of the blur across a line, pixels squared.
    LineBlur,
    /// Offset of a line's middle in red against that in luma, along the normal, pixels.
    RedOffset,
    /// Offset of a line's middle in blue against that in luma, along the normal, pixels.
    BlueOffset,
    /// Natural logarithm of the variance of luma on a block of carpet.
    NoiseVariance,
    /// Distance forward in one step of the odometry, metres.
    OdometryForward,
    /// Distance to the left in one step of the odometry, metres.
    OdometryLeft,
    /// Turn to the left in one step of the odometry, radians.
    OdometryTurn,
    /// Pitch of the camera by joints and IMU, without its usual difference from that of the reference poses, radians.
    StatedPitch,
    /// The same of its roll.
    StatedRoll,
}

impl ColorChannel {
    /// All colour channels.
    pub(crate) const ALL: [Self; 3] = [Self::Red, Self::Green, Self::Blue];
}

impl Quantity {
    /// Three quantities of an odometry step.
    pub(crate) const ODOMETRY: [Self; 3] = [Self::OdometryForward, Self::OdometryLeft, Self::OdometryTurn];

    /// Pitch and roll by joints and IMU.
    pub(crate) const STATED: [Self; 2] = [Self::StatedPitch, Self::StatedRoll];

    /// All quantities.
    #[cfg(test)]
    pub(crate) const ALL: [Self; 16] = [
        Self::LineOffset,
        Self::LineLevel(ColorChannel::Red),
        Self::LineLevel(ColorChannel::Green),
        Self::LineLevel(ColorChannel::Blue),
        Self::CarpetLevel(ColorChannel::Red),
        Self::CarpetLevel(ColorChannel::Green),
        Self::CarpetLevel(ColorChannel::Blue),
        Self::LineBlur,
        Self::RedOffset,
        Self::BlueOffset,
        Self::NoiseVariance,
        Self::OdometryForward,
        Self::OdometryLeft,
        Self::OdometryTurn,
        Self::StatedPitch,
        Self::StatedRoll,
    ];

    pub(crate) const fn channel(self) -> Channel {
        match self {
            Self::LineOffset => Channel::Geometry,
            Self::LineLevel(_) | Self::CarpetLevel(_) => Channel::Photometry,
            Self::LineBlur => Channel::Sharpness,
            Self::RedOffset | Self::BlueOffset => Channel::Color,
            Self::NoiseVariance => Channel::Noise,
            Self::OdometryForward
            | Self::OdometryLeft
            | Self::OdometryTurn
            | Self::StatedPitch
            | Self::StatedRoll => Channel::Motion,
        }
    }

    /// Whether the odometry, joints or IMU measure it, not a picture.
    pub(crate) fn is_proprioceptive(self) -> bool {
        self.channel() == Channel::Motion
    }

    /// Returns the surface whose level it is.
    pub(crate) fn surface(self) -> Option<Surface> {
        match self {
            Self::LineLevel(_) => Some(Surface::Line),
            Self::CarpetLevel(_) => Some(Surface::Carpet),
            _ => None,
        }
    }

    /// Iterates over the levels of lines and of carpet.
    pub(crate) fn levels() -> impl Iterator<Item = Self> {
        ColorChannel::ALL.into_iter().flat_map(|color| [Self::LineLevel(color), Self::CarpetLevel(color)])
    }

    /// Whether it is a level of lines or of carpet.
    pub(crate) fn is_level(self) -> bool {
        self.surface().is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_listed_in_order_and_grouped_by_channel() {
        assert!(Quantity::ALL.is_sorted());
        let mut channels = Quantity::ALL.map(Quantity::channel).to_vec();
        channels.dedup();
        assert_eq!(channels, Channel::ALL);
        for channel in Channel::ALL {
            assert!(Quantity::ALL.iter().any(|quantity| quantity.channel() == channel));
        }
    }
}
