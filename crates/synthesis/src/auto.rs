//! The recorded picture where there is one, else one drawn from its neighbours.

use reality_sim_core::pose::CameraPose;

use crate::{Blend, Method, Reconstruction, SynthesisError, Synthesizer, nearest::as_recorded};

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
        let near = from.nearest(pose, from.config().candidates)?;
        let mut recorded = near.into_iter().take_while(|neighbour| neighbour.distance_px <= RECORDED_PX);
        match recorded.find(|neighbour| from.archive().camera_of(neighbour.image) == from.camera()) {
            Some(neighbour) => as_recorded(from, neighbour),
            None => Blend.reconstruct(from, pose),
        }
    }
}
