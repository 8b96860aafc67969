//! The recorded picture if there is one at the pose, else one drawn from its neighbours.

use reality_sim_core::pose::CameraPose;
use reality_sim_db::index::Neighbour;

use crate::{Blend, Memory, Method, Provenance, SynthesisError, Synthesizer, nearest::as_recorded};

/// Distance within which a picture counts as recorded at the requested pose, root mean square pixels.
const RECORDED_PX: f64 = 0.5;

/// Method that returns the recorded picture if a camera like the requested one took one at the pose, to half a pixel, and nothing
/// is to be left out of it; otherwise the same as [`Blend`].
#[derive(Debug, Clone, Copy)]
pub struct Auto;

impl Method for Auto {
    fn name(&self) -> &'static str {
        "auto"
    }

    fn draw(
        &self,
        from: &Synthesizer,
        pose: CameraPose,
        memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        let near = from.nearest(pose, from.config().candidates)?;
        let mut recorded = near.into_iter().take_while(|neighbour| neighbour.distance_px <= RECORDED_PX);
        let view = from.clean_view()?;
        let is_wanted = |neighbour: &Neighbour| {
            from.archive().camera_of(neighbour.image) == from.camera()
                && view.is_none_or(|view| view.mask(neighbour.image).is_none())
        };
        match recorded.find(is_wanted) {
            Some(neighbour) => as_recorded(from, neighbour, colors),
            None => Blend.draw(from, pose, memory, colors),
        }
    }
}
