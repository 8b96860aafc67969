//! Conversion from linear values to the numbers in the file.

use glam::Vec3;

use crate::tone::Tone;

/// Encoder of pixel values: full scale times the tone curve's output for the linear value, rounded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Encoding {
    exponent: f32,
    contrast: f32,
}

impl Encoding {
    pub(crate) fn new(tone: Tone) -> Self {
        Self { exponent: (1.0 / tone.gamma) as f32, contrast: tone.contrast as f32 }
    }

    /// Encodes a pixel; values above full scale are clipped.
    pub(crate) fn encode(self, linear_rgb: Vec3) -> [u8; 3] {
        linear_rgb.to_array().map(|linear| {
            let encoded = linear.clamp(0.0, 1.0).powf(self.exponent);
            let bend = self.contrast * encoded * (1.0 - encoded) * (2.0 * encoded - 1.0);
            (255.0 * (encoded + bend).clamp(0.0, 1.0)).round() as u8
        })
    }
}
