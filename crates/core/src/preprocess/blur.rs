//! Separable Gaussian blur.

use image::GrayImage;
use rayon::prelude::*;

/// Blurs with a Gaussian of `sigma_px`, truncated at three sigma; values at the edge are repeated outside. A sigma of
/// zero, below zero or NaN leaves the picture unchanged.
pub fn gaussian_blur(picture: &GrayImage, sigma_px: f32) -> GrayImage {
    let kernel = gaussian_kernel(sigma_px);
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if kernel.len() == 1 || width == 0 || height == 0 {
        return picture.clone();
    }
    let across = blur_rows(picture.as_raw(), width, &kernel);
    let blurred = blur_columns(&across, width, &kernel);
    // The buffer holds exactly one value per pixel, as its size requires.
    GrayImage::from_raw(picture.width(), picture.height(), blurred).unwrap_or_default()
}

/// Returns an odd number of weights that sum to one; a single weight if sigma is zero, below zero or NaN.
pub fn gaussian_kernel(sigma_px: f32) -> Vec<f32> {
    if !(sigma_px > 0.0 && sigma_px.is_finite()) {
        return vec![1.0];
    }
    let radius = (3.0 * sigma_px).ceil().min(255.0) as i32;
    let weight = |i: i32| (-0.5 * (i as f32 / sigma_px).powi(2)).exp();
    let sum: f32 = (-radius..=radius).map(weight).sum();
    (-radius..=radius).map(|i| weight(i) / sum).collect()
}

fn blur_rows(values: &[u8], width: usize, kernel: &[f32]) -> Vec<f32> {
    let mut across = vec![0.0_f32; values.len()];
    let rows = across.par_chunks_mut(width).zip(values.par_chunks(width));
    rows.for_each(|(out, row)| blur_row(row, kernel, out));
    across
}

fn blur_columns(across: &[f32], width: usize, kernel: &[f32]) -> Vec<u8> {
    let mut blurred = vec![0_u8; across.len()];
    let rows = blurred.par_chunks_mut(width).enumerate();
    rows.for_each(|(y, out)| blur_column(across, y, kernel, out));
    blurred
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
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

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
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

#[cfg(test)]
mod tests {
    use image::Luma;
    use proptest::prelude::*;

    use super::*;

    /// Computes the same blur as a plain two-dimensional sum.
    fn direct(picture: &GrayImage, sigma: f64) -> Vec<f64> {
        let radius = (3.0 * sigma).ceil() as i64;
        let (width, height) = (i64::from(picture.width()), i64::from(picture.height()));
        let mut out = Vec::new();
        for v in 0..height {
            for u in 0..width {
                let (mut sum, mut total) = (0.0, 0.0);
                for dv in -radius..=radius {
                    for du in -radius..=radius {
                        let weight = (-0.5 * (du * du + dv * dv) as f64 / (sigma * sigma)).exp();
                        let (x, y) = ((u + du).clamp(0, width - 1), (v + dv).clamp(0, height - 1));
                        sum += weight * f64::from(picture.get_pixel(x as u32, y as u32).0[0]);
                        total += weight;
                    }
                }
                out.push(sum / total);
            }
        }
        out
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn agrees_with_the_plain_sum(values in prop::collection::vec(any::<u8>(), 13 * 9), sigma in 0.3..2.5_f64) {
            let picture = GrayImage::from_raw(13, 9, values).unwrap();
            let blurred = gaussian_blur(&picture, sigma as f32);
            for (value, expected) in blurred.as_raw().iter().zip(direct(&picture, sigma)) {
                // Half a level for rounding, plus the error of single precision.
                prop_assert!((f64::from(*value) - expected).abs() <= 0.51);
            }
        }
    }

    #[test]
    fn no_sigma_no_blur_and_tiny_pictures_survive() {
        let picture = GrayImage::from_fn(2, 1, |u, _| Luma([u as u8 * 200]));
        for sigma in [0.0, -1.0, f32::NAN] {
            assert_eq!(gaussian_blur(&picture, sigma), picture);
        }
        assert_eq!(gaussian_blur(&GrayImage::new(0, 0), 2.0).dimensions(), (0, 0));
        assert_eq!(gaussian_blur(&picture, 30.0).dimensions(), (2, 1));
    }
}
