//! The recorded picture where there is one, else one drawn from its neighbours.

use reality_sim_core::pose::CameraPose;

use crate::{Blend, Method, Nearest, Reconstruction, SynthesisError, Synthesizer};

/// A picture whose pixels lie this near to where they should, root mean square, was recorded at the pose asked for.
const RECORDED_PX: f64 = 0.5;

/// The recorded picture where one was taken at the pose, to half a pixel, by a camera like the one wanted; else [`Blend`].
#[derive(Debug, Clone, Copy)]
pub struct Auto;

impl Method for Auto {
    fn name(&self) -> &'static str {
        "auto"
    }

    fn reconstruct(&self, from: &Synthesizer, pose: CameraPose) -> Result<Reconstruction, SynthesisError> {
        let is_like = |image| from.archive().camera_of(image) == from.camera();
        let near = from.nearest(pose, from.config().candidates)?;
        let mut recorded = near.iter().take_while(|neighbour| neighbour.distance_px <= RECORDED_PX);
        // The nearest of the size is then the nearest of the lens, or as near to half a pixel.
        let is_recorded = recorded.any(|neighbour| is_like(neighbour.image));
        if is_recorded { Nearest.reconstruct(from, pose) } else { Blend.reconstruct(from, pose) }
    }
}
