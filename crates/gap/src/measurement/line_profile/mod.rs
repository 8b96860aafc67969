//! Profile of a white line in the picture: its middle, the blur of its edges, and the offsets of its colours.
//!
//! The samples are all pixels of a short piece of line, by their distance from its middle. As the line crosses the grid of
//! pixels at a slant, they sample its edges far more finely than one row of pixels does (slanted-edge method of ISO 12233).
//! The fitted profile is a bright bar between two flanks in linear light, blurred by a Gaussian, then encoded.

mod bar_fit;
mod color_offset;
mod samples;
#[cfg(test)]
mod tests;

use image::RgbImage;

pub(crate) use self::samples::LinePiece;
use self::{
    bar_fit::fit_bar,
    color_offset::{colors, inner_level},
    samples::{Sample, samples},
};
use crate::thresholds::{ProfileThresholds, Thresholds};

const THRESHOLDS: ProfileThresholds = Thresholds::DEFAULT.measurement.profile;

/// Measurements of a piece of line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Profile {
    /// Offset of its middle from the predicted one along the normal, pixels.
    pub(crate) offset_px: f64,
    /// Standard deviation of the offset by the fit alone, pixels.
    pub(crate) offset_sigma_px: f64,
    /// Variance of the blur along the normal, the pixel's own included, pixels squared; not a number where the line is cut off
    /// at white, so that its edges seem steeper.
    pub(crate) variance_px2: f64,
    /// Standard deviation of the variance by the fit alone, pixels squared.
    pub(crate) variance_sigma_px2: f64,
    /// Offsets of red and of blue against luma along the normal, pixels.
    pub(crate) color_offset_px: Option<[f64; 2]>,
    /// Share of each colour in luma's contrast; they add up to 1.
    pub(crate) contrast_share: [f64; 3],
    /// Mean encoded values (0–1) of the line's inner part, where it is wide enough to have one.
    pub(crate) level: Option<[f64; 3]>,
}

/// Fits the profile of a piece that the coarse search has found `found_px` from the predicted middle along the normal. None
/// if no line fits.
pub(crate) fn fit(picture: &RgbImage, gamma: f64, piece: &LinePiece, found_px: f64) -> Option<Profile> {
    let samples = samples(picture, piece, found_px)?;
    let bar = fit_bar(&samples, gamma, piece, found_px)?;
    let center = bar.values[0];
    let levels =
        [bar.values[2], bar.values[3], bar.values[4]].map(|linear| linear.max(0.0).powf(1.0 / gamma));
    let contrast = levels[0] - 0.5 * (levels[1] + levels[2]);
    (contrast > THRESHOLDS.least_contrast && bar.residual < THRESHOLDS.most_residual * contrast)
        .then_some(())?;
    let sharp_px = bar.values[1].sqrt();
    let (color_offset_px, contrast_share) = colors(&samples, center, piece.half_width_px, sharp_px)?;
    let inner_px =
        piece.half_width_px - THRESHOLDS.inner_margin_sigmas * sharp_px - THRESHOLDS.inner_margin_px;
    Some(Profile {
        offset_px: center,
        offset_sigma_px: bar.sigma[0],
        variance_px2: if is_cut_off(&samples) { f64::NAN } else { bar.values[1] },
        variance_sigma_px2: bar.sigma[1],
        color_offset_px,
        contrast_share,
        level: inner_level(&samples, center, inner_px),
    })
}

/// Whether a part of the samples is white as far as the encoding tells.
fn is_cut_off(samples: &[Sample]) -> bool {
    let white = samples.iter().filter(|sample| sample.rgb.iter().any(|value| *value > THRESHOLDS.white));
    white.count() as f64 > THRESHOLDS.most_white_share * samples.len() as f64
}
