//! Warps through the ground plane and both lenses; what is not on the ground goes through goals and proxy geometry.

use reality_sim_core::pose::CameraPose;

use crate::{Memory, Method, Provenance, SynthesisError, Synthesizer};

/// Method that maps exactly from the neighbour that shows most of the target best.
#[derive(Debug, Clone, Copy)]
pub struct Plane;

impl Method for Plane {
    fn name(&self) -> &'static str {
        "plane"
    }

    fn draw(
        &self,
        from: &Synthesizer,
        pose: CameraPose,
        memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        from.warped(self.name(), pose, 1, memory, colors)
    }
}

/// Method that maps several neighbours like [`Plane`] and mixes them pixel by pixel, see
/// [`reality_sim_core::warp::blend`].
#[derive(Debug, Clone, Copy)]
pub struct Blend;

impl Method for Blend {
    fn name(&self) -> &'static str {
        "blend"
    }

    fn draw(
        &self,
        from: &Synthesizer,
        pose: CameraPose,
        memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        from.warped(self.name(), pose, from.config().sources, memory, colors)
    }
}
