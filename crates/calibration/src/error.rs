//! Reasons why a recording cannot be calibrated.

use reality_sim_core::{camera::InvalidCamera, localization::LocalizationError, sequence::SequenceError};

/// Reason why there is no calibration.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A picture of the recording cannot be read.
    #[error(transparent)]
    Sequence(#[from] Box<SequenceError>),
    /// The pictures cannot be localized.
    #[error(transparent)]
    Localization(#[from] Box<LocalizationError>),
    /// The guess of the field of view makes no camera of this model.
    #[error("a field of view of {fov_deg}° is impossible for this lens model: {reason}")]
    FieldOfView {
        /// Field of view across the width of the picture, degrees.
        fov_deg: f64,
        /// Why there is no such camera.
        reason: InvalidCamera,
    },
    /// No lens, height and poses explain the white lines in the pictures.
    #[error(
        "no lens explains the white lines in these pictures as lines of this field (the best explains {:.0} %): the field's file may \
         belong to another field, the field of view may be farther off than a third, or pitch and roll in frames.csv may be wrong",
        100.0 * explained
    )]
    NothingFits {
        /// Largest median fraction of the white lines that was explained.
        explained: f64,
    },
    /// Too few pictures show enough lines.
    #[error(
        "only {usable} of {tried} pictures show enough lines to be fitted, and {least} are needed: record more pictures that look at the \
         lines of the field"
    )]
    TooFewPictures {
        /// Number of pictures that could be fitted.
        usable: usize,
        /// Number of pictures that were tried.
        tried: usize,
        /// Smallest number with which a calibration is attempted.
        least: usize,
    },
}

impl From<SequenceError> for CalibrationError {
    fn from(error: SequenceError) -> Self {
        Box::new(error).into()
    }
}

impl From<LocalizationError> for CalibrationError {
    fn from(error: LocalizationError) -> Self {
        Box::new(error).into()
    }
}
