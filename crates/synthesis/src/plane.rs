//! One neighbour, through the ground plane and both lenses; what does not lie on the ground, through goals and proxy geometry.

use reality_sim_core::pose::CameraPose;

use crate::{Method, Reconstruction, SynthesisError, Synthesizer};

/// The exact map from the neighbour that shows most of the target best.
#[derive(Debug, Clone, Copy)]
pub struct Plane;

impl Method for Plane {
    fn name(&self) -> &'static str {
        "plane"
    }

    fn reconstruct(&self, from: &Synthesizer, pose: CameraPose) -> Result<Reconstruction, SynthesisError> {
        from.warped(self.name(), pose, 1)
    }
}

/// Several neighbours, each mapped as by [`Plane`], mixed pixel by pixel: see [`reality_sim_core::warp::blend`].
#[derive(Debug, Clone, Copy)]
pub struct Blend;

impl Method for Blend {
    fn name(&self) -> &'static str {
        "blend"
    }

    fn reconstruct(&self, from: &Synthesizer, pose: CameraPose) -> Result<Reconstruction, SynthesisError> {
        from.warped(self.name(), pose, from.config().sources)
    }
}
