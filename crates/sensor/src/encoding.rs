//! From linear light to the numbers in the file.

use glam::Vec3;
use reality_sim_core::sequence::Photometry;

/// Gamma of a camera whose photometry is not known.
const DEFAULT_GAMMA: f64 = 2.2;

/// A pixel value is full scale times the linear value to the power of 1 / gamma, rounded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Encoding {
    exponent: f32,
}

impl Encoding {
    pub(crate) fn new(photometry: Option<&Photometry>) -> Self {
        let gamma = photometry.map_or(DEFAULT_GAMMA, |photometry| photometry.gamma);
        Self { exponent: (1.0 / gamma) as f32 }
    }

    /// What is brighter than full scale is cut off.
    pub(crate) fn encode(self, linear_rgb: Vec3) -> [u8; 3] {
        linear_rgb.to_array().map(|value| (255.0 * value.clamp(0.0, 1.0).powf(self.exponent)).round() as u8)
    }
}
