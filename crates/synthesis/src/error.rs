//! Reasons why there is no picture at a pose.

use reality_sim_core::{
    backend::BackendError,
    pose::{CameraPose, FARTHEST_M},
};
use reality_sim_db::{DbError, index::NoNeighbours};

/// Reason why a picture cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// The database cannot be read.
    #[error(transparent)]
    Database(#[from] DbError),
    /// The database holds no images.
    #[error("{database}: holds no images: ingest a recording")]
    Empty {
        /// Path of its file.
        database: String,
    },
    /// The database holds no clean stage.
    #[error(
        "{database}: holds no clean stage, which pictures without people, robots and balls need: build it again, from pictures that show the field's carpet"
    )]
    NoCleanStage {
        /// Path of its file.
        database: String,
    },
    /// The camera that took most images sees too little of the field for distances between poses.
    #[error(
        "{database}: the camera sees too little of the field for distances between poses: give another camera to the recording, and build the database anew"
    )]
    BlindCamera {
        /// Path of its file.
        database: String,
    },
    /// Nothing was recorded near the pose.
    #[error("{}: {reason}", shown(.pose))]
    NoNeighbours {
        /// Pose that was asked for.
        pose: CameraPose,
        /// Reason.
        reason: NoNeighbours,
    },
    /// The recorded images show too little of what is seen from the pose.
    #[error(
        "{}: recorded pictures show {:.0} % of what is seen from there, {:.0} % are needed: record pictures there, or ask for the best effort",
        shown(.pose), 100.0 * .covered, 100.0 * .needed
    )]
    TooLittleSeen {
        /// Pose that was asked for.
        pose: CameraPose,
        /// Share of the pixels that recorded images show, 0 to 1.
        covered: f64,
        /// Share of the pixels that is needed, 0 to 1.
        needed: f64,
    },
    /// No camera above the field can have this pose.
    #[error(
        "{}: a camera is above the ground and within {FARTHEST_M:.0} m of the field's centre: give another pose",
        shown(.pose)
    )]
    ImpossiblePose {
        /// Pose that was asked for.
        pose: CameraPose,
    },
    /// No image near the pose has the size of the requested camera.
    #[error("{}: no picture near it has {width} x {height} pixels: use the method `plane` or `blend`", shown(.pose))]
    OtherSize {
        /// Pose that was asked for.
        pose: CameraPose,
        /// Width of the requested picture, pixels.
        width: u32,
        /// Height of the requested picture, pixels.
        height: u32,
    },
    /// The points of the ground that both cameras see do not determine a polynomial.
    #[error("{}: the nearest picture and this pose have too few points of the ground in common: use the method `plane` or `blend`", shown(.pose))]
    TooFewPoints {
        /// Pose that was asked for.
        pose: CameraPose,
    },
    /// The buffer for the picture has the wrong length.
    #[error("the buffer has {found} bytes, not {expected}: three for every pixel of the camera, row by row")]
    BufferLength {
        /// Length of the given buffer, bytes.
        found: usize,
        /// Length of a picture, bytes.
        expected: usize,
    },
    /// The device that draws has failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
}

impl SynthesisError {
    /// Whether there is no picture because too little was recorded near the pose, rather than because of a fault.
    pub fn is_refusal(&self) -> bool {
        matches!(
            self,
            Self::NoNeighbours { .. }
                | Self::TooLittleSeen { .. }
                | Self::TooFewPoints { .. }
                | Self::OtherSize { .. }
        )
    }
}

/// Formats a pose; large numbers take few digits.
fn shown(pose: &CameraPose) -> String {
    let number = |value: f64| if value.abs() < 1e6 { format!("{value:.2}") } else { format!("{value:.1e}") };
    let [x, y, yaw, height] = [pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m].map(number);
    format!("pose {x} m, {y} m, {yaw} rad, height {height} m")
}
