//! Interface of the methods, and calls for pictures.

use reality_sim_core::pose::CameraPose;

use crate::{Reconstruction, SynthesisError, Synthesizer};

/// Method that makes the picture at a pose from those recorded at others.
pub trait Method: Send + Sync {
    /// Returns the name of the method.
    fn name(&self) -> &'static str;

    /// Returns the picture at a pose that has been checked, see [`Synthesizer::image_at`].
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

    /// Draws the picture at a pose into a buffer: RGB, row by row from the top left, three bytes per pixel of
    /// [`Synthesizer::camera`]. Returns the share of the pixels that some recorded image shows, 0 to 1. After an error the
    /// buffer is unchanged.
    pub fn image_into(
        &self,
        pose: CameraPose,
        method: &dyn Method,
        buffer: &mut [u8],
    ) -> Result<f64, SynthesisError> {
        let expected = 3 * self.camera().width as usize * self.camera().height as usize;
        if buffer.len() != expected {
            return Err(SynthesisError::BufferLength { found: buffer.len(), expected });
        }
        let reconstruction = self.image_at(pose, method)?;
        buffer.copy_from_slice(&reconstruction.picture);
        Ok(reconstruction.covered())
    }
}
