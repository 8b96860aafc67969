//! What changes from picture to picture and keeps no place: bands of light that roll, things that come and go.

use crate::{
    diagnostics::residual_patterns::Residuals,
    inference::gain::sum_of,
    inference::hypothesis_test::two_sided,
    measurement::quantity::{Channel, ColorChannel, Quantity},
    measurement::scalar::Measurement,
    report::data::Unexplained,
    thresholds::Thresholds,
};

/// Bands into which a picture is cut, along its rows and along its columns.
const BANDS: usize = 12;
/// A band has so many rows of measurements at least.
const LEAST_ROWS: usize = 5;
/// Bands weaker than this do not matter, natural logarithm of light.
const MATERIAL: f64 = 0.03;
/// More of the carpet than this hidden by other things is worth a word.
const HIDDEN: f64 = 0.04;
/// Carpet is hidden where it is so many standard deviations off.
const OUTLYING: f64 = 5.0;

/// Bands of brightness along the rows that differ from picture to picture. Carpet's own patches make bands, too, but
/// along the columns as much as along the rows.
pub(crate) fn bands(frames: &[Residuals<'_>]) -> Option<Unexplained> {
    let along = |place: fn(&Measurement, [u32; 2]) -> f64| -> Vec<f64> {
        let cut: Vec<Vec<Option<f64>>> = frames.iter().map(|frame| band_means(frame, place)).collect();
        // What every picture has is a pattern of the picture.
        let usual: Vec<f64> =
            (0..BANDS).map(|band| mean(cut.iter().filter_map(|bands| bands[band])).unwrap_or(0.0)).collect();
        cut.iter()
            .map(|bands| {
                variance(bands.iter().zip(&usual).filter_map(|(mean, usual)| Some((*mean)? - usual)))
            })
            .collect()
    };
    let rows = along(|row, size| row.pixel.y / f64::from(size[1]));
    let columns = along(|row, size| row.pixel.x / f64::from(size[0]));
    let differences: Vec<f64> = rows.iter().zip(&columns).map(|(row, column)| row - column).collect();
    let sum = sum_of(&differences);
    let count = frames.len() as f64;
    let size = (sum.value.max(0.0) / count).sqrt();
    let p_value = two_sided(sum.value / sum.sigma.max(1e-12), count - 1.0);
    (size > MATERIAL && p_value < Thresholds::DEFAULT.inference.significance).then(|| Unexplained {
        channel: Channel::Photometry.name().to_owned(),
        r#where: "bands along the rows that differ from picture to picture, as of lamps that flicker"
            .to_owned(),
        size,
        unit: Channel::Photometry.unit().to_owned(),
        p_value: Some(p_value),
    })
}

/// Things in front of the carpet that the model does not have.
pub(crate) fn things(frames: &[Residuals<'_>], sigma: f64) -> Option<Unexplained> {
    let hidden = |frame: &Residuals<'_>| {
        let carpet = frame
            .measurements
            .iter()
            .zip(&frame.values)
            .filter(|(row, value)| is_green_carpet(row) && value.is_finite());
        let outlying: Vec<bool> = carpet.map(|(_, value)| is_outlying(*value, sigma)).collect();
        (!outlying.is_empty())
            .then(|| outlying.iter().filter(|outlying| **outlying).count() as f64 / outlying.len() as f64)
    };
    let part = mean(frames.iter().filter_map(hidden))?;
    (part > HIDDEN).then(|| Unexplained {
        channel: Channel::Photometry.name().to_owned(),
        r#where: format!(
            "{:.0} % of the carpet in view is hidden by things that the model does not have",
            100.0 * part
        ),
        size: part,
        unit: "1".to_owned(),
        p_value: None,
    })
}

/// Whether a block shows something else than carpet.
pub(crate) fn is_outlying(value: f64, sigma: f64) -> bool {
    value.abs() > OUTLYING * sigma
}

pub(crate) fn is_green_carpet(row: &Measurement) -> bool {
    row.quantity == Quantity::CarpetLevel(ColorChannel::Green)
}

fn band_means(frame: &Residuals<'_>, place: fn(&Measurement, [u32; 2]) -> f64) -> Vec<Option<f64>> {
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); BANDS];
    for (row, value) in frame.measurements.iter().zip(&frame.values) {
        if is_green_carpet(row) && value.is_finite() {
            let band = (place(row, frame.size) * BANDS as f64).clamp(0.0, BANDS as f64 - 1.0);
            values[band as usize].push(*value);
        }
    }
    let means = values
        .iter_mut()
        .map(|values| (values.len() >= LEAST_ROWS).then(|| crate::linear_model::system::median(values)));
    means.collect()
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
    use crate::testing::carpet_measurement;

    const SIGMA: f64 = 0.05;
    const SIZE: [u32; 2] = [320, 240];

    /// Pictures of carpet with this residual at a picture's number and a place in fractions of its size.
    fn with_pictures<T>(residual: impl Fn(u32, DVec2) -> f64, judge: impl Fn(&[Residuals<'_>]) -> T) -> T {
        let size = DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
        let pixels: Vec<DVec2> =
            (0..1200).map(|i| 8.0 * DVec2::new(f64::from(i % 40), f64::from(i / 40))).collect();
        let rows: Vec<Measurement> =
            pixels.iter().map(|&pixel| carpet_measurement(pixel, pixel / 100.0)).collect();
        // A little texture, another in every block and picture.
        let texture =
            |frame: u32, index: usize| 0.01 * (((index * 31 + frame as usize * 17) % 7) as f64 - 3.0) / 3.0;
        let frames: Vec<Residuals<'_>> = (0..24)
            .map(|frame| Residuals {
                measurements: &rows,
                values: (0..)
                    .zip(&pixels)
                    .map(|(index, pixel)| residual(frame, *pixel / size) + texture(frame, index))
                    .collect(),
                time_s: f64::from(frame),
                camera: DVec2::ZERO,
                size: SIZE,
            })
            .collect();
        judge(&frames)
    }

    /// A wave along a fraction, its phase another in every picture.
    fn rolling(frame: u32, along: f64) -> f64 {
        0.1 * (TAU * (2.0 * along + 0.37 * f64::from(frame))).sin()
    }

    #[test]
    fn bands_that_roll_along_the_rows_are_found_with_their_size() {
        let found = with_pictures(|frame, place| rolling(frame, place.y), bands).unwrap();
        // A sine's root mean square.
        assert!((found.size - 0.07).abs() < 0.015, "{}", found.size);
        assert!(found.p_value.unwrap() < Thresholds::DEFAULT.inference.significance);
    }

    #[test]
    fn bands_that_stay_or_run_along_the_columns_and_even_carpet_are_none() {
        assert_eq!(with_pictures(|_, place| rolling(0, place.y), bands), None);
        assert_eq!(with_pictures(|frame, place| rolling(frame, place.x), bands), None);
        assert_eq!(
            with_pictures(|frame, place| rolling(frame, place.x) + rolling(frame, place.y), bands),
            None
        );
        assert_eq!(with_pictures(|_, _| 0.0, bands), None);
    }

    #[test]
    fn things_are_told_by_the_part_of_the_carpet_that_they_hide() {
        let covered = |part: f64| move |_: u32, place: DVec2| if place.x < part { -1.0 } else { 0.0 };
        let judge = |frames: &[Residuals<'_>]| things(frames, SIGMA);
        let found = with_pictures(covered(0.1), judge).unwrap();
        assert!((found.size - 0.1).abs() < 0.03, "{}", found.size);
        assert_eq!(with_pictures(covered(0.02), judge), None);
    }
}
