//! What a way to a picture at a pose is, and how it is asked.

use reality_sim_core::pose::CameraPose;

use crate::{Reconstruction, SynthesisError, Synthesizer};

/// A way to a picture at a pose from those recorded at others.
pub trait Method: Send + Sync {
    /// What it is called.
    fn name(&self) -> &'static str;

    /// The picture at a pose that has been checked, see [`Synthesizer::image_at`].
    fn reconstruct(&self, from: &Synthesizer, pose: CameraPose) -> Result<Reconstruction, SynthesisError>;
}

impl Synthesizer {
    /// Returns the picture at a pose, by a method.
    pub fn image_at(&self, pose: CameraPose, method: &dyn Method) -> Result<Reconstruction, SynthesisError> {
        if pose.is_finite() && !pose.is_possible() {
            return Err(SynthesisError::ImpossiblePose { pose });
        }
        let near = self.archive().index().check_reach(pose, self.config().reach_px);
        near.map_err(|reason| SynthesisError::NoNeighbours { pose, reason })?;
        method.reconstruct(self, pose)
    }
}
