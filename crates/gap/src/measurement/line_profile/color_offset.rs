//! Offsets of the colour channels against luma across a line, and the colour of the line.

use super::samples::Sample;
use crate::{
    measurement::luma::LUMA,
    thresholds::{ProfileThresholds, Thresholds},
};

const THRESHOLDS: ProfileThresholds = Thresholds::DEFAULT.measurement.profile;

/// Returns the offsets of red and blue against luma, from the centroids of the contrast with the flanks, and each colour's
/// share in the contrast of luma. Averaging does not move centroids, so chroma stored at half the resolution does not bias
/// the offsets.
pub(super) fn colors(
    samples: &[Sample],
    center: f64,
    half_width_px: f64,
    sharp_px: f64,
) -> Option<(Option<[f64; 2]>, [f64; 3])> {
    let reach =
        |side: f64| samples.iter().map(|sample| side * (sample.across_px - center)).fold(0.0, f64::max);
    let inner = half_width_px
        + THRESHOLDS.color_window_sigmas * sharp_px.hypot(THRESHOLDS.chroma_sigma_px)
        + THRESHOLDS.color_window_margin_px;
    let inner = inner.min(reach(1.0).min(reach(-1.0)) - THRESHOLDS.least_color_flank_px);
    let mut flank = [[0.0; 5]; 2];
    for sample in samples {
        let across = sample.across_px - center;
        if across.abs() > inner {
            let sums = &mut flank[usize::from(across > 0.0)];
            add(sums, &with_luma(sample), 1.0);
            sums[4] += 1.0;
        }
    }
    if flank.iter().any(|sums| sums[4] < THRESHOLDS.least_flank_pixels) {
        return None;
    }
    let level = flank.map(|sums| [0, 1, 2, 3].map(|channel| sums[channel] / sums[4]));
    let (mut mass, mut moment) = ([0.0; 4], [0.0; 4]);
    let window = inner + 0.5;
    for sample in samples {
        let across = sample.across_px - center;
        if across.abs() <= window {
            // Under the line, the level of the flanks is interpolated between both sides.
            let fraction = 0.5 + 0.5 * across / window;
            for (channel, value) in with_luma(sample).into_iter().enumerate() {
                let stands_out =
                    value - level[0][channel] - fraction * (level[1][channel] - level[0][channel]);
                mass[channel] += stands_out;
                moment[channel] += stands_out * across;
            }
        }
    }
    let total: f64 = (0..3).map(|channel| LUMA[channel] * mass[channel]).sum();
    (total > 0.0).then_some(())?;
    let share = [0, 1, 2].map(|channel| LUMA[channel] * mass[channel] / total);
    let middle = |channel: usize| moment[channel] / mass[channel] - moment[3] / mass[3];
    let clear = (0..3).all(|channel| mass[channel] > THRESHOLDS.least_color_contrast * total);
    Some((clear.then(|| [middle(0), middle(2)]), share))
}

fn with_luma(sample: &Sample) -> [f64; 4] {
    let [r, g, b] = sample.rgb;
    [r, g, b, sample.luma]
}

fn add(sums: &mut [f64; 5], values: &[f64; 4], weight: f64) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// Returns the mean encoded values within some distance of the middle. None if there are too few pixels.
pub(super) fn inner_level(samples: &[Sample], center: f64, within_px: f64) -> Option<[f64; 3]> {
    (within_px > THRESHOLDS.least_inner_half_width_px).then_some(())?;
    let inside = samples.iter().filter(|sample| (sample.across_px - center).abs() < within_px);
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for sample in inside {
        for (sum, value) in sum.iter_mut().zip(sample.rgb) {
            *sum += value;
        }
        count += 1.0;
    }
    (count >= THRESHOLDS.least_inner_pixels).then(|| sum.map(|sum| sum / count))
}
