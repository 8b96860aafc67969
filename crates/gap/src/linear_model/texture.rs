//! Fine texture of the carpet, which looks like noise: its variance at each resolution of the ground.
//!
//! With noise of variance `n` and texture of variance `x n`, the logarithm of the variance is `ln n + ln(1 + x)`. It is
//! replaced by `x ln(1 + x₀) / x₀`, which is exact without texture and for the texture `x₀` that the recording shows: where the
//! light is bright, texture may have several times the variance of noise.

use reality_sim_core::statistics::median;
use reality_sim_sensor::Chain;

use crate::{
    frame_index::PerFrame,
    linear_model::{prediction::log_noise, rounding::Rounding},
    measurement::{frame::FrameMeasurements, quantity::Quantity, scalar::Measurement},
    thresholds::{NuisanceThresholds, Thresholds},
};

const THRESHOLDS: NuisanceThresholds = Thresholds::DEFAULT.linear_model.nuisance;

/// Number of resolutions at which the contrast of the carpet's texture is free.
pub(crate) const OCTAVES: usize = 5;

/// Squares of the texture's contrast that a recording shows, by the octave of the ground's resolution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct CarpetTexture([f64; OCTAVES]);

impl CarpetTexture {
    /// Takes what is more in the medians of measured variances than in the model's noise for texture.
    pub(crate) fn new(measurements: &PerFrame<FrameMeasurements>, chain: &Chain, gamma: f64) -> Self {
        let mut squares: [Vec<f64>; OCTAVES] = Default::default();
        for (frame, rounding) in measurements.iter().zip(Rounding::of_frames(measurements)) {
            let noise = frame.measurements(gamma).into_iter();
            let noise = noise.filter(|row| row.quantity == Quantity::NoiseVariance);
            for (row, block) in noise.zip(&frame.blocks) {
                let more = row.measured.exp() - log_noise(chain, &rounding, block).exp();
                let square = more / unit_variance(&row);
                if square.is_finite() {
                    squares[position(&row).round() as usize].push(square);
                }
            }
        }
        Self(squares.map(|squares| if squares.is_empty() { 0.0 } else { median(squares).max(0.0) }))
    }

    /// Returns the derivative of the logarithm of the variance by the square of the contrast at an octave, in units of
    /// `contrast` squared.
    pub(crate) fn derivative(
        &self,
        octave: usize,
        contrast: f64,
        measurement: &Measurement,
        predicted: f64,
    ) -> f64 {
        let position = position(measurement);
        let part = |octave: usize| (1.0 - (position - octave as f64).abs()).max(0.0);
        let variance = unit_variance(measurement) * (-predicted).exp();
        let seen: f64 = (0..OCTAVES).map(|octave| part(octave) * self.0[octave] * variance).sum();
        let secant = if seen > 1e-6 { seen.ln_1p() / seen } else { 1.0 };
        let derivative = part(octave) * contrast * contrast * variance * secant;
        if derivative.is_finite() { derivative } else { 0.0 }
    }
}

/// Returns the variance of a texture whose contrast is 1, grey levels squared.
fn unit_variance(measurement: &Measurement) -> f64 {
    (255.0 * measurement.luma_slope).powi(2)
}

/// Returns the resolution of the ground in octaves below that straight down. Seen from the same height, it is as cos^1.5 of
/// the angle of incidence: that along the view times that across.
fn position(measurement: &Measurement) -> f64 {
    let below = -1.5 * measurement.cos_incidence.max(1e-3).ln() / THRESHOLDS.texture_octave.ln();
    below.clamp(0.0, OCTAVES as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::measurement;

    fn block(cos_incidence: f64, luma_slope: f64) -> Measurement {
        Measurement { cos_incidence, luma_slope, ..measurement(Quantity::NoiseVariance) }
    }

    #[test]
    fn texture_of_one_contrast_at_all_resolutions_adds_the_same_variance_everywhere() {
        for cos_incidence in [1.0, 0.7, 0.4, 0.15, 0.03] {
            let block = block(cos_incidence, 0.2);
            let octave = |octave| CarpetTexture::default().derivative(octave, 0.01, &block, 0.0);
            let sum: f64 = (0..OCTAVES).map(octave).sum();
            assert!((sum - (255.0 * 0.01 * 0.2_f64).powi(2)).abs() < 1e-12, "{cos_incidence}: {sum}");
        }
    }

    #[test]
    fn the_texture_that_was_seen_changes_the_logarithm_by_its_exact_amount() {
        let texture = CarpetTexture([4e-4; OCTAVES]);
        for (cos_incidence, luma_slope) in [(0.9, 0.1), (0.5, 0.3), (0.2, 0.6)] {
            let block = block(cos_incidence, luma_slope);
            let change: f64 = (0..OCTAVES).map(|octave| texture.derivative(octave, 0.02, &block, 1.0)).sum();
            let noise = 1.0_f64.exp();
            let wanted = ((noise + 4e-4 * unit_variance(&block)) / noise).ln();
            assert!((change - wanted).abs() < 1e-12, "{change} {wanted}");
        }
    }
}
