//! Bands of brightness that roll over the picture, as flickering lamps cause them with a rolling shutter.

use reality_sim_core::statistics::median;

use crate::{
    diagnostics::{
        carpet,
        detector::{Detector, FitResiduals, FrameResiduals},
        finding::Finding,
    },
    inference::hypothesis_test::series_p_value,
    measurement::scalar::Measurement,
    thresholds::{FlickerThresholds, Thresholds},
};

const THRESHOLDS: FlickerThresholds = Thresholds::DEFAULT.diagnostics.flicker;
const BANDS: usize = THRESHOLDS.bands;

/// Detector of bands of brightness along the rows that differ from picture to picture.
pub(crate) struct Flicker;

impl Detector for Flicker {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        Vec::from_iter(flicker(&fit.frames))
    }
}

/// Returns the bands along the rows, if they vary more than those along the columns. Patches of the carpet cause bands along
/// both alike.
fn flicker(frames: &[FrameResiduals<'_>]) -> Option<Finding> {
    let rows = band_variances(frames, |measurement, size| measurement.pixel.y / f64::from(size[1]));
    let columns = band_variances(frames, |measurement, size| measurement.pixel.x / f64::from(size[0]));
    let differences: Vec<f64> = rows.iter().zip(&columns).map(|(row, column)| row - column).collect();
    let sum: f64 = differences.iter().sum();
    let mean = sum / frames.len().max(1) as f64;
    let size = mean.max(0.0).sqrt();
    let deviations: Vec<f64> = differences.iter().map(|difference| difference - mean).collect();
    let p_value = series_p_value(sum, &deviations);
    (size > THRESHOLDS.material && p_value < Thresholds::DEFAULT.inference.significance)
        .then_some(Finding::Flicker { size, p_value })
}

/// Returns the variance of the bands of each frame. `place` gives the position of a measurement across the bands, 0 to 1.
fn band_variances(frames: &[FrameResiduals<'_>], place: fn(&Measurement, [u32; 2]) -> f64) -> Vec<f64> {
    let bands: Vec<Vec<Option<f64>>> = frames.iter().map(|frame| band_medians(frame, place)).collect();
    // Bands that all pictures have in common are a pattern of the picture.
    let usual: Vec<f64> =
        (0..BANDS).map(|band| mean(bands.iter().filter_map(|bands| bands[band])).unwrap_or(0.0)).collect();
    bands
        .iter()
        .map(|bands| {
            variance(bands.iter().zip(&usual).filter_map(|(median, usual)| Some((*median)? - usual)))
        })
        .collect()
}

fn band_medians(frame: &FrameResiduals<'_>, place: fn(&Measurement, [u32; 2]) -> f64) -> Vec<Option<f64>> {
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); BANDS];
    for (measurement, value) in carpet::blocks(frame) {
        let band = (place(measurement, frame.size) * BANDS as f64).clamp(0.0, BANDS as f64 - 1.0);
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

    use glam::DVec2;

    use super::*;
    use crate::{diagnostics::carpet::pictures::with_walk, testing::Noise};

    /// Wave along a fraction of the picture, with a phase that differs from picture to picture.
    fn rolling(frame: u32, along: f64) -> f64 {
        0.1 * (TAU * (2.0 * along + 0.37 * f64::from(frame))).sin()
    }

    #[test]
    fn bands_that_roll_along_the_rows_are_found_with_their_size() {
        let found = with_walk(|frame, place, _| rolling(frame, place.y), flicker).unwrap();
        // Root mean square of a sine with amplitude 0.1.
        assert!((found.size() - 0.07).abs() < 0.015, "{found:?}");
        assert!(found.p_value().unwrap() < Thresholds::DEFAULT.inference.significance);
    }

    #[test]
    fn constant_bands_bands_along_the_columns_and_even_carpet_are_no_flicker() {
        assert_eq!(with_walk(|_, place, _| rolling(0, place.y), flicker), None);
        assert_eq!(with_walk(|frame, place, _| rolling(frame, place.x), flicker), None);
        assert_eq!(
            with_walk(|frame, place, _| rolling(frame, place.x) + rolling(frame, place.y), flicker),
            None
        );
        assert_eq!(with_walk(|_, _, _| 0.0, flicker), None);
    }

    #[test]
    fn noise_of_single_pictures_is_seldom_flicker_whatever_its_size() {
        // Every picture has bands of its own along rows and columns alike.
        let mut noise = Noise(1);
        let found = (0..200).filter(|_| {
            let waves: Vec<[f64; 2]> = (0..24).map(|_| [noise.next(), noise.next()]).collect();
            let bands = |frame: u32, place: DVec2| {
                let [rows, columns] = waves[frame as usize];
                0.1 * (rows * (TAU * 2.0 * place.y).sin() + columns * (TAU * 2.0 * place.x).sin())
            };
            with_walk(|frame, place, _| bands(frame, place), flicker).is_some()
        });
        let found = found.count();
        assert!(found <= 4, "{found} of 200");
    }
}
