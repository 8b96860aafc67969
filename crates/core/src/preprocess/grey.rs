//! Grey values of a colour picture.

use image::{GrayImage, RgbImage};
use rayon::prelude::*;

/// Weights of red, green and blue in luma, ITU-R BT.601, as in JPEG files.
pub const LUMA_WEIGHTS: [f64; 3] = [0.299, 0.587, 0.114];

/// Returns the luma by ITU-R BT.601 with weights in 256ths, rounded down.
pub fn luma(picture: &RgbImage) -> GrayImage {
    map_pixels(picture, |[r, g, b]| ((u32::from(r) * 77 + u32::from(g) * 150 + u32::from(b) * 29) >> 8) as u8)
}

/// Returns the smallest of the three channels: large only where a pixel is bright *and* colourless, as white lines are;
/// small on carpet, coloured goals, balls and robots.
pub fn whiteness(picture: &RgbImage) -> GrayImage {
    map_pixels(picture, |[r, g, b]| r.min(g).min(b))
}

fn map_pixels(picture: &RgbImage, value: impl Fn([u8; 3]) -> u8 + Sync) -> GrayImage {
    let (width, height) = picture.dimensions();
    let mut values = vec![0; (width * height) as usize];
    let row_length = width.max(1) as usize;
    values.par_chunks_mut(row_length).zip(picture.as_raw().par_chunks(3 * row_length)).for_each(
        |(values, row)| {
            for (target, rgb) in values.iter_mut().zip(row.chunks_exact(3)) {
                *target = value([rgb[0], rgb[1], rgb[2]]);
            }
        },
    );
    // The buffer holds exactly one value per pixel, as its size requires.
    GrayImage::from_raw(width, height, values).unwrap_or_default()
}
