//! Sharpening of finished pictures by an unsharp mask, and what it makes of blur and noise.
//!
//! Encoded values `v` become `v + amount · (v − blurred v)`, where the blur has a standard deviation of 1 pixel. A negative amount blurs, as
//! cameras do against noise.

use glam::Vec3;
use image::{Rgb, RgbImage};
use rayon::prelude::*;

use crate::{blur::blurred, light::Light};

/// Standard deviation of the mask's blur, pixels: about that of the 3 × 3 and 5 × 5 kernels of cameras.
pub(crate) const RADIUS_PX: f64 = 1.0;

/// Returns a picture sharpened by this amount.
pub(crate) fn sharpened(picture: &RgbImage, amount: f64) -> RgbImage {
    let mut light = Light::dark([picture.width(), picture.height()]);
    light.rows_mut().enumerate().for_each(|(v, row)| {
        for (u, light) in row.iter_mut().enumerate() {
            *light = Vec3::from_array(picture.get_pixel(u as u32, v as u32).0.map(f32::from));
        }
    });
    let smooth = blurred(light, |_| RADIUS_PX * RADIUS_PX);
    let mut made = picture.clone();
    for (v, row) in (0..picture.height()).zip(made.rows_mut()) {
        for (pixel, smooth) in row.zip(smooth.nearest_row(v as isize)) {
            let value = Vec3::from_array(pixel.0.map(f32::from));
            let sharp = value + amount as f32 * (value - *smooth);
            *pixel = Rgb(sharp.to_array().map(|value| value.round().clamp(0.0, 255.0) as u8));
        }
    }
    made
}

/// Returns the variance, pixels squared, of the Gaussian blur whose edge is as steep in its middle as one blurred by
/// `variance_px2` and then sharpened: the slope of an edge is inversely proportional to the standard deviation.
pub(crate) fn sharpened_variance_px2(variance_px2: f64, amount: f64) -> f64 {
    if amount == 0.0 || variance_px2 <= 0.0 {
        return variance_px2;
    }
    let slope = (1.0 + amount) / variance_px2.sqrt() - amount / (variance_px2 + RADIUS_PX * RADIUS_PX).sqrt();
    1.0 / (slope * slope)
}

/// Returns the factor on the amplitude of a wave with these angular frequencies along rows and columns, radians per pixel.
pub(crate) fn sharpened_amplitude(frequency_rad_px: [f64; 2], amount: f64) -> f64 {
    // A kernel of diffusing heat with variance t damps a wave by e^(−t (1 − cos ω)) along each axis (Lindeberg 1990).
    let damped: f64 = frequency_rad_px.iter().map(|frequency| 1.0 - frequency.cos()).sum();
    1.0 + amount * (1.0 - (-RADIUS_PX * RADIUS_PX * damped).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the picture of a vertical wave with this period, pixels.
    fn wave(period_px: f64, amplitude: f64) -> RgbImage {
        RgbImage::from_fn(96, 8, |u, _| {
            let value = 128.0 + amplitude * (std::f64::consts::TAU * f64::from(u) / period_px).cos();
            Rgb([value.round() as u8; 3])
        })
    }

    #[test]
    fn waves_grow_by_the_stated_factor() {
        for (period_px, amount) in [(4.0, 0.5), (8.0, 0.8), (6.0, -0.5)] {
            let picture = sharpened(&wave(period_px, 60.0), amount);
            let factor = sharpened_amplitude([std::f64::consts::TAU / period_px, 0.0], amount);
            // A crest in the middle, away from the sides.
            let crest = f64::from(picture.get_pixel(48, 4).0[1]) - 128.0;
            assert!((crest - 60.0 * factor).abs() < 1.5, "{crest} instead of {}", 60.0 * factor);
        }
    }

    #[test]
    fn plain_pictures_stay_as_they_are() {
        let plain = RgbImage::from_pixel(12, 9, Rgb([40, 90, 50]));
        assert_eq!(sharpened(&plain, 0.7), plain);
    }

    #[test]
    fn edges_get_steeper_and_smoothed_ones_less_steep() {
        // A blur of 0.8 px and 30 %: fits of a Gaussian bar to the sharpened one give 0.50 px².
        let sharper = sharpened_variance_px2(0.64, 0.3);
        assert!((sharper - 0.50).abs() < 0.03, "{sharper}");
        assert!(sharpened_variance_px2(0.64, -0.3) > 0.64);
        assert_eq!(sharpened_variance_px2(0.64, 0.0), 0.64);
    }
}
