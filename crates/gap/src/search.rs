//! Where, across it, a piece of line roughly is: as wide as the model has it, or else as a blur has spread it.

use reality_sim_core::{
    field::VisibleSample,
    preprocess::Texture,
    refine::{MeasureConfig, measure_offsets},
};
use statrs::function::erf::erf;

/// Blurs that lines are looked for with, one after the other, until they are found: standard deviation beside the one that
/// is expected, pixels.
const EXTRA_BLUR_PX: [f64; 4] = [0.0, 1.5, 3.0, 5.0];
/// A line stands out from the carpet by at least this where nothing blurs it, grey levels.
const MIN_CONTRAST: f64 = 25.0;
/// And by at least this where something does: carpet has as much of its own.
const LEAST_CONTRAST: f64 = 8.0;
/// Half the width of a Gaussian at half its height, in standard deviations.
const HALF_HEIGHT: f64 = 1.177;

/// A piece of line, found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coarse {
    pub(crate) visible: VisibleSample,
    /// From where it is expected, along its normal, pixels.
    pub(crate) offset_px: f64,
    /// Variance of the blur with which it was found, beside the one that is expected, pixels squared.
    pub(crate) extra_px2: f64,
}

/// Looks for pieces of line, up to `search_px` from where they are expected. `accepts` has the last word: what it turns
/// down is looked for with more blur.
pub(crate) fn search<T>(
    texture: &Texture,
    expected: &[VisibleSample],
    search_px: f64,
    accepts: impl Fn(&Coarse) -> Option<T>,
) -> Vec<T> {
    let mut left = expected.to_vec();
    let mut found = Vec::with_capacity(expected.len());
    for extra_px in EXTRA_BLUR_PX {
        left.retain(|visible| {
            let wide = widened(visible, extra_px);
            let config = MeasureConfig { search_px, min_contrast: min_contrast(visible, extra_px) };
            let offset = measure_offsets(texture, &[wide], config);
            let accepted = offset.first().and_then(|offset| {
                let (visible, offset_px) = (*visible, offset.offset_px);
                accepts(&Coarse { visible, offset_px, extra_px2: extra_px * extra_px })
            });
            let is_left = accepted.is_none();
            found.extend(accepted);
            is_left
        });
    }
    found
}

/// A line as wide at half its height as a blur makes it.
fn widened(visible: &VisibleSample, extra_px: f64) -> VisibleSample {
    VisibleSample { half_width_px: visible.half_width_px.max(HALF_HEIGHT * extra_px), ..*visible }
}

/// What a blur leaves of a line's contrast.
fn min_contrast(visible: &VisibleSample, extra_px: f64) -> f64 {
    let left =
        if extra_px > 0.0 { erf(visible.half_width_px / (extra_px * std::f64::consts::SQRT_2)) } else { 1.0 };
    (left * MIN_CONTRAST).max(LEAST_CONTRAST)
}
