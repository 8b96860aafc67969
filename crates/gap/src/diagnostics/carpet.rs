//! Blocks of carpet, and whether something hides them.

use std::collections::BTreeMap;

use crate::{
    diagnostics::detector::FrameResiduals,
    measurement::quantity::{ColorChannel, Quantity},
    measurement::scalar::Measurement,
    thresholds::Thresholds,
};

/// Quantity that distinguishes carpet from what hides it.
const GREEN: Quantity = Quantity::CarpetLevel(ColorChannel::Green);
/// Smallest residual of a hidden block, standard deviations.
const HIDDEN_SIGMAS: f64 = Thresholds::DEFAULT.diagnostics.hidden_sigmas;

/// Returns the blocks of carpet of a frame, each with the residual of its green level (natural logarithm).
pub(super) fn blocks<'a>(frame: &'a FrameResiduals<'_>) -> impl Iterator<Item = (&'a Measurement, f64)> {
    let measured = frame.measurements.iter().zip(frame.values.iter().copied());
    measured.filter(|(measurement, value)| measurement.quantity == GREEN && value.is_finite())
}

/// Returns the standard deviation of a block's residual; infinite if no block was measured.
pub(super) fn sigma(sigmas: &BTreeMap<Quantity, f64>) -> f64 {
    sigmas.get(&GREEN).copied().unwrap_or(f64::INFINITY)
}

/// Whether a block shows something other than carpet.
pub(super) fn is_hidden(residual: f64, sigma: f64) -> bool {
    residual.abs() > HIDDEN_SIGMAS * sigma
}

#[cfg(test)]
pub(super) mod pictures {
    //! Pictures of carpet for the tests of detectors.

    use glam::DVec2;

    use super::*;
    use crate::testing::carpet_measurement;

    /// Standard deviation of a block's residual.
    pub(in super::super) const SIGMA: f64 = 0.05;
    const SIZE: [u32; 2] = [320, 240];

    /// Calls `check` with 24 pictures of carpet, taken while the camera moves by 20 cm from picture to picture. `residual`
    /// gives a block's residual from the picture's number, the block's place as fractions of the picture's size, and its
    /// point on the ground.
    pub(in super::super) fn with_walk<T>(
        residual: impl Fn(u32, DVec2, DVec2) -> f64,
        check: impl Fn(&[FrameResiduals<'_>]) -> T,
    ) -> T {
        let size = DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
        let pixels: Vec<DVec2> =
            (0..1200).map(|i| 8.0 * DVec2::new(f64::from(i % 40), f64::from(i / 40))).collect();
        let ground = |frame: u32, pixel: DVec2| pixel / 100.0 + DVec2::new(0.2 * f64::from(frame), 0.0);
        let measurements: Vec<Vec<Measurement>> = (0..24)
            .map(|frame| {
                pixels.iter().map(|&pixel| carpet_measurement(pixel, ground(frame, pixel))).collect()
            })
            .collect();
        // A faint texture that differs from block to block and from picture to picture.
        let texture =
            |frame: u32, index: usize| 0.01 * (((index * 31 + frame as usize * 17) % 7) as f64 - 3.0) / 3.0;
        let frames: Vec<FrameResiduals<'_>> = (0..)
            .zip(&measurements)
            .map(|(frame, measurements)| FrameResiduals {
                measurements,
                values: (0..)
                    .zip(&pixels)
                    .map(|(index, &pixel)| {
                        residual(frame, pixel / size, ground(frame, pixel)) + texture(frame, index)
                    })
                    .collect(),
                time_s: f64::from(frame),
                camera: DVec2::ZERO,
                size: SIZE,
            })
            .collect();
        check(&frames)
    }
}
