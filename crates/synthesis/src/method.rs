//! Interface of the methods, and calls for pictures.

use image::RgbImage;
use reality_sim_core::pose::CameraPose;

use crate::{Memory, Provenance, Reconstruction, SynthesisError, Synthesizer};

/// Method that makes the picture at a pose from those recorded at others.
pub trait Method: Send + Sync {
    /// Returns the name of the method.
    fn name(&self) -> &'static str;

    /// Draws the picture at a pose that has been checked, see [`Synthesizer::image_into`], and returns where its pixels come
    /// from. `colors` has one element for every pixel of [`Synthesizer::camera`], row by row from the top left; after an
    /// error it may hold anything. `memory` tells of the picture before, if there was one.
    fn draw(
        &self,
        from: &Synthesizer,
        pose: CameraPose,
        memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError>;
}

impl Synthesizer {
    /// Returns the picture at a pose, by a method.
    pub fn image_at(&self, pose: CameraPose, method: &dyn Method) -> Result<Reconstruction, SynthesisError> {
        let mut picture = RgbImage::new(self.camera().width, self.camera().height);
        let provenance = self.image_into(pose, method, &mut picture)?;
        Ok(Reconstruction::new(picture, provenance))
    }

    /// Draws the picture at a pose into a buffer: RGB, row by row from the top left, three bytes per pixel of
    /// [`Synthesizer::camera`]. Returns where the pixels come from. After an error the buffer may hold anything.
    pub fn image_into(
        &self,
        pose: CameraPose,
        method: &dyn Method,
        buffer: &mut [u8],
    ) -> Result<Provenance, SynthesisError> {
        self.image_along(pose, method, &mut Memory::default(), buffer)
    }

    /// Works like [`Synthesizer::image_into`], for one picture after the other of a camera that moves: what the last one was
    /// made from is kept while it does. Each camera needs a memory of its own.
    pub fn image_along(
        &self,
        pose: CameraPose,
        method: &dyn Method,
        memory: &mut Memory,
        buffer: &mut [u8],
    ) -> Result<Provenance, SynthesisError> {
        let expected = 3 * self.rays().pixels();
        if buffer.len() != expected {
            return Err(SynthesisError::BufferLength { found: buffer.len(), expected });
        }
        self.check(pose)?;
        let (colors, _) = buffer.as_chunks_mut();
        let provenance = method.draw(self, pose, memory, colors)?;
        if let Some(shading) = self.archive().shading_of(self.camera()) {
            shading.put_in(colors);
        }
        Ok(provenance)
    }

    /// Checks that a camera can be at a pose, and that something was recorded near it.
    pub(crate) fn check(&self, pose: CameraPose) -> Result<(), SynthesisError> {
        if pose.is_finite() && !pose.is_possible() {
            return Err(SynthesisError::ImpossiblePose { pose });
        }
        let near = self.archive().index().check_reach(pose, self.config().reach_px);
        near.map_err(|reason| SynthesisError::NoNeighbours { pose, reason })?;
        Ok(())
    }
}
