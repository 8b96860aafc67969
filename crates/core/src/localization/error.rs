//! Errors of localizing a picture or a recording.

use crate::{backend_error::BackendError, sequence::SequenceError};

/// Reason why a picture or recording could not be localized.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LocalizationError {
    /// A picture of a recording cannot be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The device that weighs the particles failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// The picture does not have the camera's size.
    #[error(
        "the picture has {} x {} pixels and the camera {} x {}: give pictures of the camera, or the camera of the pictures",
        found[0], found[1], expected[0], expected[1]
    )]
    PictureSize {
        /// Width and height of the picture, pixels.
        found: [u32; 2],
        /// Width and height of the camera, pixels.
        expected: [u32; 2],
    },
}
