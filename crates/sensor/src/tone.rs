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

/// Error of a tone curve without a valid gamma.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the gamma would be {gamma}, which is not above 0")]
pub struct InvalidTone {
    /// Exponent that is not above 0, or NaN.
    pub gamma: f64,
}

impl Tone {
    /// Returns the curve with this gamma and bend. Fails where the gamma is not above 0.
    pub fn new(gamma: f64, contrast: f64) -> Result<Self, InvalidTone> {
        if gamma > 0.0 { Ok(Self { gamma, contrast }) } else { Err(InvalidTone { gamma }) }
    }

    /// Returns the encoded value, 0 to 1; clips linear values to 0 to 1.
    pub fn encode(self, linear: f64) -> f64 {
        let encoded = linear.clamp(0.0, 1.0).powf(1.0 / self.gamma);
        let bend = self.contrast * encoded * (1.0 - encoded) * (2.0 * encoded - 1.0);
        (encoded + bend).clamp(0.0, 1.0)
    }
}
