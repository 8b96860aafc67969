//! What changes from picture to picture and keeps no place: bands of light that roll, things that come and go.

use crate::{
    evidence::{sum_of, two_sided},
    naming::ALPHA,
    report::Unexplained,
    rows::{Channel, Row},
    unknown::Residuals,
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
    let along = |place: fn(&Row, [u32; 2]) -> f64| -> Vec<f64> {
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
    (size > MATERIAL && p_value < ALPHA).then(|| Unexplained {
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
            .rows
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

pub(crate) fn is_green_carpet(row: &Row) -> bool {
    row.group.channel == Channel::Photometry && row.group.part == 4
}

fn band_means(frame: &Residuals<'_>, place: fn(&Row, [u32; 2]) -> f64) -> Vec<Option<f64>> {
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); BANDS];
    for (row, value) in frame.rows.iter().zip(&frame.values) {
        if is_green_carpet(row) && value.is_finite() {
            let band = (place(row, frame.size) * BANDS as f64).clamp(0.0, BANDS as f64 - 1.0);
            values[band as usize].push(*value);
        }
    }
    let means =
        values.iter_mut().map(|values| (values.len() >= LEAST_ROWS).then(|| crate::system::median(values)));
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
