//! Report of an import.

use serde::Serialize;

use super::topics::Choice;

/// What was imported, from where, and what was not.
#[derive(Debug, Clone, Serialize)]
pub struct ImportReport {
    /// Number of frames of the sequence.
    pub frames: usize,
    /// Number of pictures that were left out, as no pitch and roll, or no odometry, were known at their time.
    pub unmatched: usize,
    /// Whether the log was cut off or is damaged, and read as far as it can be.
    pub salvaged: bool,
    /// Length of what could not be read, bytes; an estimate within compressed parts.
    pub bytes_lost: u64,
    /// Number of jumps of the clock.
    pub clock_jumps: usize,
    /// Number of pictures that are there twice.
    pub doubled: usize,
    /// Number of pictures that are missing between others, by the usual time between two.
    pub lost: usize,
    /// Number of pictures that cannot be used.
    pub unusable: usize,
    /// Number of other messages that are damaged.
    pub damaged: usize,
    /// Number of messages without a time of their own, for which that of the log was taken.
    pub without_stamp: usize,
    /// Topics that were read.
    pub topics: UsedTopics,
    /// Source of the camera's pitch and roll.
    pub attitude_source: String,
    /// Source of the odometry, if there is any.
    pub odometry_source: Option<String>,
    /// Source of the camera's height; `None` if it is not known.
    pub height_source: Option<String>,
    /// Height of the camera above the carpet, metres; `None` if it is not known.
    pub height_m: Option<f64>,
    /// Model of the lens, by COLMAP's name; `None` if there is no calibration.
    pub camera_model: Option<&'static str>,
    /// Largest time between a picture and what was matched to it, seconds.
    pub tolerance_s: f64,
    /// What else a reader should know, a sentence each.
    pub notes: Vec<String>,
}

/// Topics that were read.
#[derive(Debug, Clone, Default, Serialize)]
pub struct UsedTopics {
    /// Pictures.
    pub image: Option<String>,
    /// Calibration.
    pub camera_info: Option<String>,
    /// Odometry.
    pub odometry: Option<String>,
    /// Reference poses.
    pub reference: Option<String>,
    /// IMU.
    pub imu: Option<String>,
    /// Joints.
    pub joints: Option<String>,
    /// Transforms.
    pub transforms: Vec<String>,
}

impl UsedTopics {
    pub(super) fn of(choice: &Choice) -> Self {
        let name = |chosen: &Option<super::topics::Chosen>| chosen.as_ref().map(|chosen| chosen.name.clone());
        Self {
            image: name(&choice.pictures),
            camera_info: name(&choice.calibration),
            odometry: name(&choice.odometry),
            reference: name(&choice.reference).or_else(|| choice.reference_frame.clone()),
            imu: name(&choice.imu),
            joints: name(&choice.joints),
            transforms: choice.transforms.iter().map(|chosen| chosen.name.clone()).collect(),
        }
    }
}
