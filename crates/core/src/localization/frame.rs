//! Result of localizing one picture.

use crate::{
    filter::FilterEstimate,
    mount::MountPose,
    pose::{CameraPose, Motion2},
    refine::PoseFit,
};

/// Pose of a picture, and how far to trust it.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalizedFrame {
    /// Time at which the picture was taken, by the observation's clock, seconds.
    pub timestamp_s: f64,
    /// Estimated pose of the camera.
    pub pose: CameraPose,
    /// Sub-pixel fit, if one was asked for and found.
    pub fit: Option<PoseFit>,
    /// Estimate of the particle filter.
    pub filter: FilterEstimate,
    /// Mount pose by joints and IMU.
    pub mount: MountPose,
    /// Motion since the previous picture, by odometry.
    pub motion: Option<Motion2>,
    /// Fraction of the line in view that the picture shows where the pose projects it. If it is small at the pose
    /// itself, the fraction at the best-fitting pose next to it.
    pub line_fraction: f64,
    /// Fraction of the white lines in the picture that are lines of the field as seen from the pose; 1 if the picture shows none.
    pub explained_fraction: f64,
    /// Whether the lines fit at this pose and nowhere else, except at its mirror pose.
    pub settled: bool,
    /// Whether the pose is settled and its mirror pose is improbable; while this is false, the pose may be wrong.
    pub sure: bool,
    /// Probability that the mirror pose, turned by 180° about the field's centre, is the right one.
    pub mirrored_probability: f64,
    /// Whether the whole field was searched for this picture.
    pub searched: bool,
    /// Computing time without decoding, seconds.
    pub seconds: f64,
}
