//! Reasons why a recording cannot be compared.

use reality_sim_gap::{MeasureError, PicturesError, RecordingError};
use reality_sim_pipeline::PipelineError;
use reality_sim_sensor::ModelError;

/// Reason why a recording could not be compared with a model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ComparisonError {
    /// There are no poses to compare at.
    #[error(transparent)]
    Poses(#[from] PipelineError),
    /// The recording does not suffice.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The model of the settings cannot be read, or does not fit the camera.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The settings leave an effect out that their model contains.
    #[error("without: the model contains {id}: remove it there, or keep it in the library")]
    HeldEffect {
        /// Name of the effect.
        id: String,
    },
    /// The settings leave an effect out that does not exist.
    #[error("without: there is no effect {id}: give one of {}", known.join(", "))]
    NoSuchEffect {
        /// Name that was given.
        id: String,
        /// Names of all effects.
        known: Vec<&'static str>,
    },
    /// A picture could not be measured.
    #[error(transparent)]
    Measurement(#[from] MeasureError),
    /// The pictures of the report cannot be made.
    #[error(transparent)]
    Pictures(#[from] PicturesError),
}
