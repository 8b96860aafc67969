//! Errors that end a pipeline early.

use std::path::PathBuf;

use reality_sim_core::{
    backend::BackendError,
    localization::LocalizationError,
    sequence::{Printable, SequenceError},
};
use reality_sim_db::DbError;
use reality_sim_synthesis::SynthesisError;

/// Error that ended a pipeline early. What was stored before it stays.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// A recording's files or pictures cannot be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The device for the filter cannot be opened.
    #[error(transparent)]
    Device(#[from] BackendError),
    /// A picture cannot be localized.
    #[error(transparent)]
    Localization(#[from] LocalizationError),
    /// The database cannot be written.
    #[error(transparent)]
    Database(#[from] DbError),
    /// The hall cannot be measured, or the clean stage not be found.
    #[error(transparent)]
    Hall(#[from] SynthesisError),
    /// A file of poses has none at the times of the pictures.
    #[error("{}: holds no poses of these pictures: localize them, and write the poses there", Printable(.file))]
    NoPoses {
        /// Path of the file.
        file: PathBuf,
    },
    /// The filter is not sure of any pose of a recording.
    #[error("{}: the filter is sure of no picture's pose: give the poses, or take unsure ones too", Printable(.folder))]
    NothingSure {
        /// Folder of the recording.
        folder: PathBuf,
    },
}
