//! Grey values of a colour picture.

use image::{GrayImage, RgbImage};

/// Luma by ITU-R BT.601, rounded down.
pub fn luma(picture: &RgbImage) -> GrayImage {
    map_pixels(picture, |[r, g, b]| ((u32::from(r) * 77 + u32::from(g) * 150 + u32::from(b) * 29) >> 8) as u8)
}

/// The smallest of the three channels: large only where a pixel is bright *and* colourless, as white lines are; small
/// on carpet, coloured goals, balls and robots.
pub fn whiteness(picture: &RgbImage) -> GrayImage {
    map_pixels(picture, |[r, g, b]| r.min(g).min(b))
}

fn map_pixels(picture: &RgbImage, value: impl Fn([u8; 3]) -> u8) -> GrayImage {
    let values = picture.as_raw().chunks_exact(3).map(|rgb| value([rgb[0], rgb[1], rgb[2]])).collect();
    // One value a pixel is just what the buffer of this size holds.
    GrayImage::from_raw(picture.width(), picture.height(), values).unwrap_or_default()
}
