//! Bands of brightness that roll over the picture, as lamps that flicker make them with a rolling shutter.

use reality_sim_core::statistics::median;

use crate::{
    diagnostics::{
        carpet,
        detector::{Detector, FitResiduals, FrameResiduals},
        finding::Finding,
    },
    inference::gain::sum_of,
    inference::hypothesis_test::two_sided,
    measurement::scalar::Measurement,
    thresholds::{FlickerThresholds, Thresholds},
};

const THRESHOLDS: FlickerThresholds = Thresholds::DEFAULT.diagnostics.flicker;
const BANDS: usize = THRESHOLDS.bands;

/// Finds bands of brightness along the rows that differ from picture to picture.
pub(crate) struct Flicker;

impl Detector for Flicker {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        Vec::from_iter(flicker(&fit.frames))
    }
}

/// Carpet's own patches make bands, too, but along the columns as much as along the rows.
fn flicker(frames: &[FrameResiduals<'_>]) -> Option<Finding> {
    let rows = band_variances(frames, |row, size| row.pixel.y / f64::from(size[1]));
    let columns = band_variances(frames, |row, size| row.pixel.x / f64::from(size[0]));
    let differences: Vec<f64> = rows.iter().zip(&columns).map(|(row, column)| row - column).collect();
    let sum = sum_of(&differences);
    let count = frames.len() as f64;
    let size = (sum.value.max(0.0) / count).sqrt();
    let p_value = two_sided(sum.value / sum.sigma.max(1e-12), count - 1.0);
    (size > THRESHOLDS.material && p_value < Thresholds::DEFAULT.inference.significance)
        .then_some(Finding::Flicker { size, p_value })
}

/// Returns for each frame the variance of its bands. `place` is the place of a measurement across the bands, 0 to 1.
fn band_variances(frames: &[FrameResiduals<'_>], place: fn(&Measurement, [u32; 2]) -> f64) -> Vec<f64> {
    let cut: Vec<Vec<Option<f64>>> = frames.iter().map(|frame| band_medians(frame, place)).collect();
    // What every picture has is a pattern of the picture.
    let usual: Vec<f64> =
        (0..BANDS).map(|band| mean(cut.iter().filter_map(|bands| bands[band])).unwrap_or(0.0)).collect();
    cut.iter()
        .map(|bands| variance(bands.iter().zip(&usual).filter_map(|(mean, usual)| Some((*mean)? - usual))))
        .collect()
}

fn band_medians(frame: &FrameResiduals<'_>, place: fn(&Measurement, [u32; 2]) -> f64) -> Vec<Option<f64>> {
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); BANDS];
    for (row, value) in carpet::blocks(frame) {
        let band = (place(row, frame.size) * BANDS as f64).clamp(0.0, BANDS as f64 - 1.0);
        values[band as usize].push(value);
    }
    values
        .iter_mut()
        .map(|values| (values.len() >= THRESHOLDS.least_blocks).then(|| median(values.iter().copied())))
        .collect()
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then_some(sum / count)
}

fn variance(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let middle = mean(values.iter().copied()).unwrap_or(0.0);
    mean(values.iter().map(|value| (value - middle).powi(2))).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::diagnostics::carpet::pictures::with_pictures;

    /// A wave along a fraction, its phase another in every picture.
    fn rolling(frame: u32, along: f64) -> f64 {
        0.1 * (TAU * (2.0 * along + 0.37 * f64::from(frame))).sin()
    }

    #[test]
    fn bands_that_roll_along_the_rows_are_found_with_their_size() {
        let found = with_pictures(|frame, place| rolling(frame, place.y), flicker).unwrap();
        // A sine's root mean square.
        assert!((found.size() - 0.07).abs() < 0.015, "{found:?}");
        assert!(found.p_value().unwrap() < Thresholds::DEFAULT.inference.significance);
    }

    #[test]
    fn bands_that_stay_or_run_along_the_columns_and_even_carpet_are_none() {
        assert_eq!(with_pictures(|_, place| rolling(0, place.y), flicker), None);
        assert_eq!(with_pictures(|frame, place| rolling(frame, place.x), flicker), None);
        assert_eq!(
            with_pictures(|frame, place| rolling(frame, place.x) + rolling(frame, place.y), flicker),
            None
        );
        assert_eq!(with_pictures(|_, _| 0.0, flicker), None);
    }
}
