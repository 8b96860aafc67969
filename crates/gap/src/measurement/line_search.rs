//! Coarse search for pieces of line along their normals, first with the predicted width and then with that after more blur.

use reality_sim_core::{
    field::VisibleSample,
    preprocess::Texture,
    refine::{MeasureConfig, measure_offsets},
};
use statrs::function::erf::erf;

use crate::thresholds::{LineThresholds, Thresholds};

const THRESHOLDS: LineThresholds = Thresholds::DEFAULT.measurement.line;
/// Half the width of a Gaussian at half its maximum, in standard deviations: √(2 ln 2).
const HALF_HEIGHT: f64 = 1.177;

/// Piece of line that the coarse search found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CoarseMatch {
    pub(crate) visible: VisibleSample,
    /// Offset from the predicted pixel along its normal, pixels.
    pub(crate) offset_px: f64,
    /// Variance of the blur, in addition to the predicted one, with which it was found, pixels squared.
    pub(crate) extra_px2: f64,
}

/// Searches for pieces of line up to `search_px` from where they are predicted. A piece that `accepts` rejects is searched for
/// again with more blur.
pub(crate) fn search<T>(
    texture: &Texture,
    expected: &[VisibleSample],
    search_px: f64,
    accepts: impl Fn(&CoarseMatch) -> Option<T>,
) -> Vec<T> {
    let mut remaining = expected.to_vec();
    let mut found = Vec::with_capacity(expected.len());
    for extra_px in THRESHOLDS.extra_blur_px {
        remaining.retain(|visible| {
            let wide = widened(visible, extra_px);
            let config = MeasureConfig { search_px, min_contrast: min_contrast(visible, extra_px) };
            let offset = measure_offsets(texture, &[wide], config);
            let accepted = offset.first().and_then(|offset| {
                let (visible, offset_px) = (*visible, offset.offset_px);
                accepts(&CoarseMatch { visible, offset_px, extra_px2: extra_px * extra_px })
            });
            let is_missing = accepted.is_none();
            found.extend(accepted);
            is_missing
        });
    }
    found
}

/// Widens a line to the width of a blur at half its maximum.
fn widened(visible: &VisibleSample, extra_px: f64) -> VisibleSample {
    VisibleSample { half_width_px: visible.half_width_px.max(HALF_HEIGHT * extra_px), ..*visible }
}

/// Returns the least contrast that a line must have after a blur, grey levels.
fn min_contrast(visible: &VisibleSample, extra_px: f64) -> f64 {
    let contrast_ratio =
        if extra_px > 0.0 { erf(visible.half_width_px / (extra_px * std::f64::consts::SQRT_2)) } else { 1.0 };
    (contrast_ratio * THRESHOLDS.least_sharp_contrast).max(THRESHOLDS.least_blurred_contrast)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use image::{GrayImage, Luma};
    use reality_sim_core::field::LineSample;

    use super::*;

    const WIDTH: f64 = 61.0;

    /// Returns a vertical bar, its middle at a column, blurred by a Gaussian, on carpet with a little texture.
    fn bar(middle: f64, half_width_px: f64, sigma_px: f64, contrast: f64) -> Texture {
        let edge = |distance: f64| 0.5 * (1.0 + erf(distance / (sigma_px * std::f64::consts::SQRT_2)));
        Texture::pack(&GrayImage::from_fn(WIDTH as u32, 41, |u, v| {
            let across = f64::from(u) - middle;
            let covered = edge(across + half_width_px) - edge(across - half_width_px);
            let texture = f64::from((u * 7 + v * 13) % 5) - 2.0;
            Luma([(90.0 + texture + contrast * covered).round() as u8])
        }))
    }

    fn expected(half_width_px: f64) -> VisibleSample {
        VisibleSample {
            sample: LineSample {
                point_in_world: DVec2::ZERO,
                tangent_in_world: DVec2::Y,
                length_m: 0.03,
                clearance_m: 1.0,
                curve: 0,
            },
            pixel: DVec2::new(30.0, 20.0),
            normal_in_image: DVec2::X,
            half_width_px,
        }
    }

    fn found(texture: &Texture, half_width_px: f64) -> Option<CoarseMatch> {
        search(texture, &[expected(half_width_px)], 6.0, |found| Some(*found)).first().copied()
    }

    #[test]
    fn a_sharp_line_is_found_without_extra_blur() {
        let coarse = found(&bar(32.3, 2.0, 0.6, 110.0), 2.0).unwrap();
        assert!((coarse.offset_px - 2.3).abs() < 0.3, "{}", coarse.offset_px);
        assert_eq!(coarse.extra_px2, 0.0);
    }

    #[test]
    fn a_line_blurred_to_four_times_its_width_is_found_with_extra_blur() {
        for middle in [27.0, 30.5, 33.0] {
            let coarse = found(&bar(middle, 1.2, 3.0, 110.0), 1.2).unwrap();
            assert!((coarse.offset_px - (middle - 30.0)).abs() < 1.0, "{} for {middle}", coarse.offset_px);
            assert!(coarse.extra_px2 > 0.0);
        }
    }

    #[test]
    fn no_line_is_found_in_plain_carpet() {
        assert!(found(&bar(30.0, 1.2, 3.0, 0.0), 1.2).is_none());
    }

    #[test]
    fn a_rejected_piece_is_searched_for_again_with_more_blur() {
        let texture = bar(30.0, 1.2, 3.0, 110.0);
        let tried = std::cell::RefCell::new(Vec::new());
        let none = search(&texture, &[expected(1.2)], 6.0, |found| {
            tried.borrow_mut().push(found.extra_px2);
            None::<()>
        });
        assert!(none.is_empty());
        assert!(tried.borrow().len() > 1 && tried.borrow().is_sorted());
    }
}
