//! Why there is no picture at a pose.

use reality_sim_core::{backend::BackendError, pose::CameraPose};
use reality_sim_db::{DbError, index::NoNeighbours};

/// A picture that cannot be given.
#[derive(Debug, thiserror::Error)]
pub enum SynthesisError {
    /// The database cannot be read.
    #[error(transparent)]
    Database(#[from] DbError),
    /// The database holds no images.
    #[error("{database}: holds no images: add a recording with `build`")]
    Empty {
        /// Its file.
        database: String,
    },
    /// The camera that took most images cannot be used to measure distances.
    #[error("{database}: the camera sees too little of the field for distances between poses")]
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
    /// The pose is one that no camera above the carpet can have.
    #[error("{}: the camera must be above the ground, and within {limit_m:.0} m of the field's centre", shown(.pose))]
    ImpossiblePose {
        /// The pose asked for.
        pose: CameraPose,
        /// Metres.
        limit_m: f64,
    },
    /// Too little of the ground is seen both from the pose and in the neighbour.
    #[error("{}: the nearest picture shares {found} points of the ground with this pose, {needed} are needed: use another method", shown(.pose))]
    TooFewPoints {
        /// The pose asked for.
        pose: CameraPose,
        /// Points found.
        found: usize,
        /// Points needed.
        needed: usize,
    },
    /// The device that draws has failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
}

impl SynthesisError {
    /// Whether there is no picture because too little was recorded near the pose: nothing is broken.
    pub fn is_refusal(&self) -> bool {
        matches!(self, Self::NoNeighbours { .. } | Self::TooLittleSeen { .. } | Self::TooFewPoints { .. })
    }
}

fn shown(pose: &CameraPose) -> String {
    format!("pose {:.2} m, {:.2} m, {:.2} rad", pose.x_m, pose.y_m, pose.yaw_rad)
}
