//! Tone curve from linear light to encoded values.

/// Tone curve from a linear value `v` to the encoded `e`, both 0 to 1: `e = v^(1/gamma)`, then
/// `e + contrast · e (1 − e) (2e − 1)`, clipped to 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Exponent of the power law, above 0.
    pub gamma: f64,
    /// Bend of the curve: 0 for a plain power law, above 0 for a curve that is steeper in the middle.
    pub contrast: f64,
}

impl Tone {
    /// Returns the encoded value, 0 to 1; clips linear values to 0 to 1.
    pub fn encode(self, linear: f64) -> f64 {
        let encoded = linear.clamp(0.0, 1.0).powf(1.0 / self.gamma);
        let bend = self.contrast * encoded * (1.0 - encoded) * (2.0 * encoded - 1.0);
        (encoded + bend).clamp(0.0, 1.0)
    }
}
