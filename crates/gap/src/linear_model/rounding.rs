//! Variance of noise after quantisation in a file.

use std::sync::Arc;

use crate::{
    frame_index::PerFrame,
    measurement::{frame::FrameMeasurements, luma::LUMA, quantization::rounded_variance},
};

/// Mean square of a coefficient of luma after quantisation, tabulated over the noise's standard deviation.
#[derive(Debug, Clone)]
pub(crate) struct Rounding {
    /// Mean squares at multiples of [`Self::STEP`], grey levels squared.
    table: Vec<f64>,
}

impl Rounding {
    /// Step of the standard deviation, grey levels.
    const STEP: f64 = 0.1;
    const COUNT: usize = 400;

    /// Tabulates the mean square for each frame. Files that were quantised alike, as those of one camera mostly are, share a table.
    pub(crate) fn of_frames<'a>(measurements: &'a PerFrame<FrameMeasurements>) -> Vec<Arc<Self>> {
        let mut tables: Vec<(&'a [f64], Arc<Self>)> = Vec::new();
        let of_frame = |frame: &'a FrameMeasurements| {
            let steps = frame.noise_steps.as_slice();
            let known = tables.iter().find(|(of, _)| *of == steps).map(|(_, table)| Arc::clone(table));
            known.unwrap_or_else(|| {
                let table = Arc::new(Self::new(steps));
                tables.push((steps, Arc::clone(&table)));
                table
            })
        };
        measurements.iter().map(of_frame).collect()
    }

    /// Tabulates the mean square over coefficients with these quantisation steps (grey levels).
    fn new(steps: &[f64]) -> Self {
        let mean = |sigma: f64| {
            let sum: f64 = steps.iter().map(|&step| rounded_variance(sigma, step)).sum();
            // Rounding of the three colours to whole pixel values adds to the variance of luma.
            sum / steps.len().max(1) as f64 + LUMA.map(|weight| weight * weight / 12.0).iter().sum::<f64>()
        };
        Self { table: (0..=Self::COUNT).map(|i| mean((i as f64 * Self::STEP).max(1e-6))).collect() }
    }

    /// Returns the mean square for noise of this standard deviation, by linear interpolation.
    pub(super) fn mean_square(&self, sigma: f64) -> f64 {
        let position = (sigma / Self::STEP).clamp(0.0, Self::COUNT as f64 - 1e-9);
        let index = position as usize;
        self.table[index] + (position - index as f64) * (self.table[index + 1] - self.table[index])
    }
}
