//! The nearest picture as it is.

use reality_sim_core::{pose::CameraPose, warp::Origin};
use reality_sim_db::index::Neighbour;

use crate::{Method, Reconstruction, SynthesisError, Synthesizer};

/// At this distance a picture's pixels are worth half, pixels.
const HALF_TRUST_PX: f64 = 10.0;

/// The nearest picture as it is, of those in the size of the camera wanted; its lens may be another.
#[derive(Debug, Clone, Copy)]
pub struct Nearest;

impl Method for Nearest {
    fn name(&self) -> &'static str {
        "nearest"
    }

    fn reconstruct(&self, from: &Synthesizer, pose: CameraPose) -> Result<Reconstruction, SynthesisError> {
        as_recorded(from, from.nearest_of_size(pose)?)
    }
}

/// An image as it is.
pub(crate) fn as_recorded(
    from: &Synthesizer,
    neighbour: Neighbour,
) -> Result<Reconstruction, SynthesisError> {
    let Neighbour { image, distance_px, .. } = neighbour;
    let picture = from.archive().picture(image)?;
    let trust = (255.0 / (1.0 + distance_px / HALF_TRUST_PX)).round() as u8;
    let origins = vec![Origin { source: 0, trust }; picture.pixels.len()];
    let used = std::iter::once((image, distance_px));
    Ok(Reconstruction::new(picture.to_rgb(), Nearest.name(), used, origins, from.rays()))
}
