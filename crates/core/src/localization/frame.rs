//! What a localizer says of one picture.

use crate::{
    filter::FilterEstimate,
    mount::MountPose,
    pose::{CameraPose, Motion2},
    refine::PoseFit,
};

/// A picture's pose, and how far to trust it.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalizedFrame {
    /// When the picture was taken, by the observation's clock, seconds.
    pub timestamp_s: f64,
    /// The pose.
    pub pose: CameraPose,
    /// The sub-pixel fit, where one was asked for and found.
    pub fit: Option<PoseFit>,
    /// The filter's own estimate.
    pub filter: FilterEstimate,
    /// Height, pitch and roll that joints and IMU told.
    pub mount: MountPose,
    /// Motion since the previous picture, by odometry.
    pub motion: Option<Motion2>,
    /// Fraction of the line in view that the picture shows where the pose puts it, or where that is little, where the pose
    /// next to it that fits best puts it.
    pub line_fraction: f64,
    /// Whether the lines fit here and nowhere else but at the mirror image of the pose on the field.
    pub settled: bool,
    /// Whether the pose is settled, and not the mirror image of the right one: false while the pose may be wrong.
    pub sure: bool,
    /// Probability that the pose turned by 180° about the field's centre is the right one.
    pub mirrored_probability: f64,
    /// Whether the whole field was searched for this picture.
    pub searched: bool,
    /// Time taken, decoding excluded, seconds.
    pub seconds: f64,
}
