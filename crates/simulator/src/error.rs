//! Reasons why the camera shows nothing.

use reality_sim_synthesis::SynthesisError;

/// Reason why a camera has no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LookError {
    /// There is no picture at the pose, or the database cannot be read.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
}

impl LookError {
    /// Returns whether there is no picture because too little was recorded near the pose, rather than because of a fault.
    pub fn is_refusal(&self) -> bool {
        match self {
            Self::Synthesis(error) => error.is_refusal(),
        }
    }
}
