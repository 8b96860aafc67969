//! How much a picture differs from what it would show of the empty ground, beyond what errors of its pose explain.

use reality_sim_core::statistics::{median, robust_sigma};

use super::predicted::{Expected, Predicted};
use crate::shrunk::ShrunkPicture;

/// Usable grey values of gains: darker ones are noise, brighter ones are saturated.
const USABLE: std::ops::Range<f32> = 10.0..245.0;
/// Pixels of which one is compared for gain and noise.
const STEP: usize = 7;
/// Largest gain, up or down.
const LARGEST_GAIN: f64 = 2.0;
/// Smallest number of pixels for a gain.
const LEAST_PIXELS: usize = 50;

/// Returns the gain that makes a picture as bright as expected; `None` where it shows too little of the ground.
pub(super) fn gain(picture: &ShrunkPicture, predicted: &Predicted) -> Option<[f32; 3]> {
    let mut ratios = [const { Vec::new() }; 3];
    for (pixel, expected) in predicted.pixels.iter().enumerate().step_by(STEP) {
        let Expected::Color(expected) = expected else { continue };
        let found = picture.color(pixel);
        for channel in 0..3 {
            if USABLE.contains(&found[channel]) && USABLE.contains(&expected[channel]) {
                ratios[channel].push(f64::from(expected[channel] / found[channel]));
            }
        }
    }
    let is_enough = ratios.iter().all(|ratios| ratios.len() >= LEAST_PIXELS);
    let range = 1.0 / LARGEST_GAIN..=LARGEST_GAIN;
    let found = ratios.map(|ratios| median(ratios).clamp(*range.start(), *range.end()) as f32);
    is_enough.then(|| std::array::from_fn(|channel| found[channel] * picture.gain[channel]))
}

/// Returns the standard deviation of pixels that show the ground, grey levels, whatever is wrong with a part of them.
pub(super) fn noise(picture: &ShrunkPicture, predicted: &Predicted) -> f32 {
    let differences = predicted.pixels.iter().enumerate().step_by(STEP).filter_map(|(pixel, expected)| {
        let Expected::Color(expected) = expected else { return None };
        let found = picture.color(pixel);
        Some([0, 1, 2].map(|channel| f64::from(found[channel] - expected[channel])))
    });
    robust_sigma(differences.flatten()) as f32
}

/// Returns how far each pixel's colour is outside the range of those expected within `reach_px` of it, grey levels: the largest
/// of the channels. `None` where no ground is expected.
pub(super) fn excesses(picture: &ShrunkPicture, predicted: &Predicted, reach_px: usize) -> Vec<Option<f32>> {
    beyond_range(picture, &predicted.pixels, predicted.width, reach_px)
}

/// Works like [`excesses`], for pixels that are expected in rows of this width.
pub(super) fn beyond_range(
    picture: &ShrunkPicture,
    expected: &[Expected],
    width: usize,
    reach_px: usize,
) -> Vec<Option<f32>> {
    let range = Range::around(expected, width, reach_px);
    let excess = |(pixel, expected): (usize, &Expected)| {
        let Expected::Color(_) = expected else { return None };
        let found = picture.color(pixel);
        let (low, high) = (range.low[pixel], range.high[pixel]);
        let beyond = (0..3).map(|channel| {
            // What is brighter than white is white.
            let found = found[channel].min(255.0);
            (low[channel] - found).max(found - high[channel])
        });
        Some(beyond.fold(0.0, f32::max))
    };
    expected.iter().enumerate().map(excess).collect()
}

/// Least and greatest colours expected around each pixel.
struct Range {
    low: Vec<[f32; 3]>,
    high: Vec<[f32; 3]>,
}

impl Range {
    fn around(expected: &[Expected], width: usize, reach_px: usize) -> Self {
        let colors = |other: f32| {
            let color = |expected: &Expected| match expected {
                Expected::Color(color) => *color,
                _ => [other; 3],
            };
            expected.iter().map(color).collect::<Vec<_>>()
        };
        Self {
            low: extremes(&colors(f32::INFINITY), width, reach_px, f32::min),
            high: extremes(&colors(f32::NEG_INFINITY), width, reach_px, f32::max),
        }
    }
}

/// Returns the extreme of each channel in squares around all pixels: along rows first, then along columns.
fn extremes(
    colors: &[[f32; 3]],
    width: usize,
    reach: usize,
    extreme: impl Fn(f32, f32) -> f32 + Copy,
) -> Vec<[f32; 3]> {
    let mut along_rows = colors.to_vec();
    for (found, row) in along_rows.chunks_mut(width).zip(colors.chunks(width)) {
        spread(found, row, 1, reach, extreme);
    }
    let mut found = along_rows.clone();
    spread(&mut found, &along_rows, width, reach, extreme);
    found
}

/// Takes the extremes of each value and those up to `reach` steps before and after it: whole slices at once, which the compiler
/// vectorises.
fn spread(
    found: &mut [[f32; 3]],
    values: &[[f32; 3]],
    step: usize,
    reach: usize,
    extreme: impl Fn(f32, f32) -> f32 + Copy,
) {
    let take = |found: &mut [[f32; 3]], values: &[[f32; 3]]| {
        let (found, values) = (found.as_flattened_mut(), values.as_flattened());
        found.iter_mut().zip(values).for_each(|(found, value)| *found = extreme(*found, *value));
    };
    for shift in (1..=reach).map(|steps| steps * step).take_while(|shift| *shift < values.len()) {
        take(&mut found[shift..], values);
        take(found, &values[shift..]);
    }
}
