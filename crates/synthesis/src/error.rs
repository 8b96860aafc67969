//! Why there is no picture at a pose.

use reality_sim_core::{
    backend::BackendError,
    pose::{CameraPose, FARTHEST_M},
};
use reality_sim_db::{DbError, index::NoNeighbours};

/// A picture that cannot be given.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// The database cannot be read.
    #[error(transparent)]
    Database(#[from] DbError),
    /// The database holds no images.
    #[error("{database}: holds no images: ingest a recording")]
    Empty {
        /// Its file.
        database: String,
    },
    /// The camera that took most images cannot be used to measure distances.
    #[error(
        "{database}: the camera sees too little of the field for distances between poses: give another camera to the recording, and build the database anew"
    )]
    BlindCamera {
        /// Its file.
        database: String,
    },
    /// Nothing was recorded near the pose.
    #[error("{}: {reason}", shown(.pose))]
    NoNeighbours {
        /// The pose asked for.
        pose: CameraPose,
        /// Why.
        reason: NoNeighbours,
    },
    /// The images recorded show too little of what is seen from the pose.
    #[error(
        "{}: recorded pictures show {:.0} % of what is seen from there, {:.0} % are needed: record pictures there, or ask for the best effort",
        shown(.pose), 100.0 * .covered, 100.0 * .needed
    )]
    TooLittleSeen {
        /// The pose asked for.
        pose: CameraPose,
        /// Share of the pixels, 0 to 1.
        covered: f64,
        /// Share of the pixels, 0 to 1.
        needed: f64,
    },
    /// The pose is one that no camera above the field can have.
    #[error(
        "{}: a camera is above the ground and within {FARTHEST_M:.0} m of the field's centre: give another pose",
        shown(.pose)
    )]
    ImpossiblePose {
        /// The pose asked for.
        pose: CameraPose,
    },
    /// No image near the pose has the size of the camera wanted.
    #[error("{}: no picture near it has {width} x {height} pixels: use the method `plane` or `blend`", shown(.pose))]
    OtherSize {
        /// The pose asked for.
        pose: CameraPose,
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// The points of the ground that both see do not determine a polynomial.
    #[error("{}: the nearest picture and this pose have too few points of the ground in common: use the method `plane` or `blend`", shown(.pose))]
    TooFewPoints {
        /// The pose asked for.
        pose: CameraPose,
    },
    /// The buffer for the picture has another length.
    #[error("the buffer has {found} bytes, not {expected}: three for every pixel of the camera, row by row")]
    BufferLength {
        /// Bytes of the buffer given.
        found: usize,
        /// Bytes of a picture.
        expected: usize,
    },
    /// The device that draws has failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
}

impl SynthesisError {
    /// Whether there is no picture because too little was recorded near the pose: nothing is broken.
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

/// Large numbers in few digits.
fn shown(pose: &CameraPose) -> String {
    let number = |value: f64| if value.abs() < 1e6 { format!("{value:.2}") } else { format!("{value:.1e}") };
    let [x, y, yaw, height] = [pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m].map(number);
    format!("pose {x} m, {y} m, {yaw} rad, height {height} m")
}
