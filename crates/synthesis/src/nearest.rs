//! The nearest picture as it is.

use reality_sim_core::{pose::CameraPose, warp::Origin};

use crate::{Method, Reconstruction, SynthesisError, Synthesizer, Used};

/// At this distance a picture's pixels are worth half, pixels.
const HALF_TRUST_PX: f64 = 10.0;

/// The nearest picture as it is, in the size of the camera that took it.
#[derive(Debug, Clone, Copy)]
pub struct Nearest;

impl Method for Nearest {
    fn name(&self) -> &'static str {
        "nearest"
    }

    fn reconstruct(&self, from: &Synthesizer, pose: CameraPose) -> Result<Reconstruction, SynthesisError> {
        let nearest = from.nearest(pose, 1)?[0];
        let picture = from.archive().picture(nearest.image)?;
        let trust = (255.0 / (1.0 + nearest.distance_px / HALF_TRUST_PX)).round() as u8;
        Ok(Reconstruction {
            picture: picture.to_rgb(),
            method: self.name(),
            origins: vec![Origin { source: 0, trust }; picture.pixels.len()],
            used: vec![Used { image: nearest.image, distance_px: nearest.distance_px, share: 1.0 }],
        })
    }
}
