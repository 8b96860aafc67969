//! Reasons why an effect cannot be hidden in a recording.

use reality_sim_core::sequence::SequenceError;
use reality_sim_sensor::{CorrectionError, ModelError};

/// Reason why an effect cannot be hidden in a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InjectionError {
    /// The effect acts while a picture is exposed: neither files nor finished pictures can be given it.
    #[error("{id} cannot be hidden in finished pictures: it acts while they are exposed")]
    WhileExposed {
        /// Id of the effect.
        id: &'static str,
    },
    /// The size is outside the range of the effect's parameter, or neutral.
    #[error("{id}: {parameter} has to be from {} to {} and other than {neutral}", .range[0], .range[1])]
    Size {
        /// Id of the effect.
        id: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Smallest and largest value.
        range: [f64; 2],
        /// Value at which the effect vanishes.
        neutral: f64,
    },
    /// The recording does not have what the effect changes.
    #[error("{id}: the recording has nothing that it would change")]
    NothingToChange {
        /// Id of the effect.
        id: &'static str,
    },
    /// The size leaves no valid camera or field.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The files cannot be changed by the effect.
    #[error(transparent)]
    Correction(#[from] CorrectionError),
    /// A picture cannot be read or written.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// There is no room for pictures.
    #[error("no folder for pictures can be made: check the temporary folder")]
    Folder(#[source] std::io::Error),
}
