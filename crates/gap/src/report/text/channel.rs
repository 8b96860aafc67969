//! Channels in words.

use crate::measurement::quantity::Channel;

/// Returns a channel as a heading: "Geometry".
pub fn channel_title(channel: Channel) -> &'static str {
    match channel {
        Channel::Color => "Colour",
        Channel::Geometry => "Geometry",
        Channel::Motion => "Motion",
        Channel::Noise => "Noise",
        Channel::Photometry => "Photometry",
        Channel::Sharpness => "Sharpness",
    }
}

/// Returns what a channel compares: "Offset of white lines along their normal".
pub fn channel_meaning(channel: Channel) -> &'static str {
    match channel {
        Channel::Color => "Offset of red and blue against the other colours along a line's normal",
        Channel::Geometry => "Offset of white lines along their normal",
        Channel::Motion => "Increments of the odometry; pitch and roll by joints and IMU",
        Channel::Noise => "Natural logarithm of the variance on plain carpet",
        Channel::Photometry => "Natural logarithm of lines' and carpet's brightness, for each colour",
        Channel::Sharpness => "Variance of the blur across a line",
    }
}

/// Returns the factor and the unit in which a channel's residuals are stated: logarithms as percent, plain numbers without a
/// unit.
pub fn channel_scale(channel: Channel) -> (f64, &'static str) {
    scale(channel, channel.unit())
}

/// Returns the factor and the unit in which a channel's size is stated, from the unit in which it is stored.
pub(super) fn scale(channel: Channel, unit: &str) -> (f64, &str) {
    match (channel, unit) {
        (Channel::Photometry | Channel::Noise | Channel::Sharpness, "1") => (100.0, "%"),
        (_, "px2") => (1.0, "px²"),
        (_, "1") => (1.0, ""),
        _ => (1.0, unit),
    }
}

/// Returns a channel as an adjective: "photometric", as in "the photometric gap".
pub(super) fn adjective(channel: Channel) -> &'static str {
    match channel {
        Channel::Color => "colour",
        Channel::Geometry => "geometric",
        Channel::Motion => "odometry",
        Channel::Noise => "noise",
        Channel::Photometry => "photometric",
        Channel::Sharpness => "sharpness",
    }
}

/// Returns a channel as a noun: "brightness", as in "brightness: in the picture, strongest …".
pub(super) fn noun(channel: Channel) -> &'static str {
    match channel {
        Channel::Color => "the colours' offset",
        Channel::Geometry => "the lines' position",
        Channel::Motion => "the odometry",
        Channel::Noise => "the noise",
        Channel::Photometry => "brightness",
        Channel::Sharpness => "sharpness",
    }
}
