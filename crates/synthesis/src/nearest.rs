//! The nearest picture as it is.

use reality_sim_core::{pose::CameraPose, warp::Origin};
use reality_sim_db::index::Neighbour;

use crate::{Memory, Method, Provenance, SynthesisError, Synthesizer};

/// Distance at which the trust in a picture's pixels is one half, pixels.
const HALF_TRUST_PX: f64 = 10.0;

/// Method that returns the nearest picture as it is, among those in the size of the requested camera; its lens may differ.
#[derive(Debug, Clone, Copy)]
pub struct Nearest;

impl Method for Nearest {
    fn name(&self) -> &'static str {
        "nearest"
    }

    fn draw(
        &self,
        from: &Synthesizer,
        pose: CameraPose,
        _memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        as_recorded(from, from.nearest_of_size(pose)?, colors)
    }
}

/// Draws an image of the wanted size as it is.
pub(crate) fn as_recorded(
    from: &Synthesizer,
    neighbour: Neighbour,
    colors: &mut [[u8; 3]],
) -> Result<Provenance, SynthesisError> {
    let Neighbour { image, distance_px, .. } = neighbour;
    let picture = from.picture(image)?;
    let trust = (255.0 / (1.0 + distance_px / HALF_TRUST_PX)).round() as u8;
    let mut origins: Vec<Origin> = picture.shown().map(|is_shown| recorded(is_shown, trust)).collect();
    let used = std::iter::once((image, distance_px));
    colors.iter_mut().zip(picture.colors()).for_each(|(drawn, color)| *drawn = color);
    from.fill_hidden(from.archive().images()[image as usize].pose, colors, &mut origins)?;
    Ok(Provenance::new(Nearest.name(), used, origins, from.rays()))
}

fn recorded(is_shown: bool, trust: u8) -> Origin {
    if is_shown { Origin { source: 0, trust } } else { Origin { source: Origin::NOWHERE, trust: 0 } }
}
