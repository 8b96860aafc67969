//! Separable Gaussian blur.

use image::GrayImage;
use rayon::prelude::*;

/// Blurs with a Gaussian of `sigma_px`, cut at three sigma; the edge's value is repeated outside. A sigma of zero (or
/// below, or NaN) leaves the picture as it is.
pub fn gaussian_blur(picture: &GrayImage, sigma_px: f32) -> GrayImage {
    let kernel = gaussian_kernel(sigma_px);
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if kernel.len() == 1 || width == 0 || height == 0 {
        return picture.clone();
    }
    let mut across = vec![0.0_f32; width * height];
    across
        .par_chunks_mut(width)
        .zip(picture.as_raw().par_chunks(width))
        .for_each(|(out, row)| blur_row(row, &kernel, out));
    let mut blurred = vec![0_u8; width * height];
    blurred.par_chunks_mut(width).enumerate().for_each(|(y, out)| blur_column(&across, y, &kernel, out));
    // One value a pixel is just what the buffer of this size holds.
    GrayImage::from_raw(picture.width(), picture.height(), blurred).unwrap_or_default()
}

/// Odd number of weights that sum to one.
fn gaussian_kernel(sigma_px: f32) -> Vec<f32> {
    if !(sigma_px > 0.0 && sigma_px.is_finite()) {
        return vec![1.0];
    }
    let radius = (3.0 * sigma_px).ceil().min(255.0) as i32;
    let weight = |i: i32| (-0.5 * (i as f32 / sigma_px).powi(2)).exp();
    let sum: f32 = (-radius..=radius).map(weight).sum();
    (-radius..=radius).map(|i| weight(i) / sum).collect()
}

fn blur_row(row: &[u8], kernel: &[f32], out: &mut [f32]) {
    let radius = kernel.len() / 2;
    let mut padded = Vec::with_capacity(row.len() + 2 * radius);
    padded.extend(std::iter::repeat_n(f32::from(row[0]), radius));
    padded.extend(row.iter().map(|&value| f32::from(value)));
    padded.extend(std::iter::repeat_n(f32::from(row[row.len() - 1]), radius));
    for (offset, &weight) in kernel.iter().enumerate() {
        for (sum, &value) in out.iter_mut().zip(&padded[offset..]) {
            *sum += weight * value;
        }
    }
}

fn blur_column(across: &[f32], y: usize, kernel: &[f32], out: &mut [u8]) {
    let (width, height) = (out.len(), across.len() / out.len());
    let radius = kernel.len() / 2;
    let mut sums = vec![0.5_f32; width];
    for (offset, &weight) in kernel.iter().enumerate() {
        let source = (y + offset).saturating_sub(radius).min(height - 1);
        for (sum, &value) in sums.iter_mut().zip(&across[source * width..][..width]) {
            *sum += weight * value;
        }
    }
    for (out, sum) in out.iter_mut().zip(sums) {
        *out = sum as u8;
    }
}
