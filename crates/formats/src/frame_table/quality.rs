//! How bright and how sharp a picture is.

use image::RgbImage;

/// Weights of red, green and blue in the grey value (ITU-R BT.601), as everywhere in this library.
const GREY_WEIGHTS: [f64; 3] = [0.299, 0.587, 0.114];

/// Brightness and sharpness of a picture, by which those of one recording are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureQuality {
    /// Mean of the grey values; 1 is full scale.
    pub brightness: f64,
    /// Standard deviation of the Laplacian of the grey values, in grey values of which 1 is full scale (Pech-Pacheco et al. 2000
    /// take its square): it falls with blur, and grows with noise.
    pub sharpness: f64,
}

impl PictureQuality {
    /// Measures a picture.
    pub fn of(picture: &RgbImage) -> Self {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let grey: Vec<f64> = picture
            .pixels()
            .map(|pixel| {
                let parts =
                    pixel.0.iter().zip(GREY_WEIGHTS).map(|(value, weight)| weight * f64::from(*value));
                parts.sum::<f64>() / 255.0
            })
            .collect();
        let brightness = grey.iter().sum::<f64>() / grey.len().max(1) as f64;
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for row in 1..height.saturating_sub(1) {
            for column in 1..width.saturating_sub(1) {
                let at = row * width + column;
                let laplacian =
                    grey[at - 1] + grey[at + 1] + grey[at - width] + grey[at + width] - 4.0 * grey[at];
                sum += laplacian;
                squares += laplacian * laplacian;
                count += 1.0;
            }
        }
        let count = f64::max(count, 1.0);
        let variance: f64 = squares / count - (sum / count) * (sum / count);
        Self { brightness, sharpness: variance.max(0.0).sqrt() }
    }
}
