//! Pixels of a piece of line, with their distances from its middle.

use glam::DVec2;
use image::RgbImage;

use crate::{
    measurement::luma::LUMA,
    thresholds::{ProfileThresholds, Thresholds},
};

const THRESHOLDS: ProfileThresholds = Thresholds::DEFAULT.measurement.profile;

/// Piece of line whose profile is measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinePiece {
    /// Predicted pixel of the middle.
    pub(crate) pixel: DVec2,
    /// Unit vector across the line in the picture.
    pub(crate) normal: DVec2,
    /// Half the width along the normal, pixels.
    pub(crate) half_width_px: f64,
    /// Predicted variance of the blur, the pixel's own aperture included, pixels squared.
    pub(crate) variance_px2: f64,
}

/// Pixel of the piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Distance from the line's predicted middle along the normal, pixels.
    pub(super) across_px: f64,
    /// Encoded values, 0–1.
    pub(super) rgb: [f64; 3],
    pub(super) luma: f64,
}

/// Returns the piece's pixels around `found_px` along the normal. None if some are outside the picture.
pub(super) fn samples(picture: &RgbImage, piece: &LinePiece, found_px: f64) -> Option<Vec<Sample>> {
    let reach =
        piece.half_width_px + THRESHOLDS.flank_sigmas * piece.variance_px2.sqrt() + THRESHOLDS.flank_px;
    let middle = piece.pixel + found_px * piece.normal;
    let along = piece.normal.perp();
    let extent = reach * piece.normal.abs() + THRESHOLDS.half_length_px * along.abs();
    let (from, to) = ((middle - extent).ceil(), (middle + extent).floor());
    let size = DVec2::new(f64::from(picture.width()), f64::from(picture.height()));
    (from.cmpge(DVec2::ZERO).all() && to.cmple(size - 1.0).all()).then_some(())?;
    let mut samples = Vec::with_capacity((4.0 * reach * THRESHOLDS.half_length_px) as usize + 16);
    for v in from.y as u32..=to.y as u32 {
        for u in from.x as u32..=to.x as u32 {
            let place = DVec2::new(f64::from(u), f64::from(v)) - middle;
            let across = place.dot(piece.normal);
            if across.abs() <= reach && place.dot(along).abs() <= THRESHOLDS.half_length_px {
                let rgb = picture.get_pixel(u, v).0.map(|value| f64::from(value) / 255.0);
                let luma = rgb.iter().zip(LUMA).map(|(value, weight)| value * weight).sum();
                samples.push(Sample { across_px: across + found_px, rgb, luma });
            }
        }
    }
    Some(samples)
}
