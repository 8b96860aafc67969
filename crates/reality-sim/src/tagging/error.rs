//! Reasons why a recording has no poses.

use std::path::PathBuf;

use reality_sim_core::{localization::LocalizationError, sequence::SequenceError};

/// Reason why a recording could not be tagged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TagError {
    /// A picture could not be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// A picture could not be localized.
    #[error(transparent)]
    Localization(#[from] LocalizationError),
    /// No picture shows enough for poses to be smoothed.
    #[error("{}: no picture shows enough of the lines to smooth the poses: leave that out", folder.display())]
    NothingToSmooth {
        /// Folder of the recording.
        folder: PathBuf,
    },
}
