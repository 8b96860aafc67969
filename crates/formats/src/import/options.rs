//! What is imported of a log, and how.

use reality_sim_core::{field::FieldDimensions, sequence::CameraSetup};

/// Tolerance with which times are matched unless another is given, seconds: half the time between two pictures at 25 Hz.
pub const TOLERANCE_S: f64 = 0.02;

/// Options of an import. Topics that are not named are found by their types.
#[derive(Debug, Clone)]
pub struct ImportOptions {
    /// Topic of the pictures.
    pub image: Option<String>,
    /// Topic of the calibration.
    pub camera_info: Option<String>,
    /// Topic of the odometry.
    pub odometry: Option<String>,
    /// Topic of the reference poses, or frame whose pose `tf` tells.
    pub reference: Option<String>,
    /// Topic of the IMU.
    pub imu: Option<String>,
    /// Topic of the joints.
    pub joints: Option<String>,
    /// Frame of the camera, instead of the one that the pictures name.
    pub camera_frame: Option<String>,
    /// Frame on the ground that does not tilt, above which the camera's height, pitch and roll are taken from `tf`.
    pub base_frame: Option<String>,
    /// Camera to use instead of the log's calibration.
    pub camera: Option<CameraSetup>,
    /// Height of the camera above the carpet, metres.
    pub height_m: Option<f64>,
    /// Whether a log without a usable calibration, or without the camera's height, is imported all the same: `camera.toml` is then
    /// left out, or lacks the height, until the sequence is calibrated.
    pub allows_uncalibrated: bool,
    /// Field on which the log was recorded.
    pub field: FieldDimensions,
    /// Largest difference between the times of a picture and of what is matched to it, seconds.
    pub tolerance_s: f64,
    /// Whether the first reference pose is written as the start.
    pub start_from_reference: bool,
    /// Name of the sequence.
    pub name: String,
}

impl ImportOptions {
    /// Makes options that choose everything by type.
    pub fn new(name: impl Into<String>, field: FieldDimensions) -> Self {
        Self {
            image: None,
            camera_info: None,
            odometry: None,
            reference: None,
            imu: None,
            joints: None,
            camera_frame: None,
            base_frame: None,
            camera: None,
            height_m: None,
            allows_uncalibrated: false,
            field,
            tolerance_s: TOLERANCE_S,
            start_from_reference: false,
            name: name.into(),
        }
    }

    /// Returns the tolerance in nanoseconds.
    pub(crate) fn tolerance_ns(&self) -> i64 {
        (self.tolerance_s * 1e9).round() as i64
    }
}
