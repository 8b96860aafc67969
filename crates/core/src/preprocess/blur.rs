//! Separable Gaussian blur.

use image::GrayImage;
use rayon::prelude::*;

/// Rows of a band that one task blurs, for each weight of the kernel: the rows beside the band are blurred along themselves once more.
const ROWS_PER_TAP: usize = 4;

/// Blurs with a Gaussian of `sigma_px`, truncated at three sigma; values at the edge are repeated outside. A sigma of
/// zero, below zero or NaN leaves the picture unchanged.
pub fn gaussian_blur(picture: &GrayImage, sigma_px: f32) -> GrayImage {
    let kernel = gaussian_kernel(sigma_px);
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if kernel.len() == 1 || width == 0 || height == 0 {
        return picture.clone();
    }
    let mut blurred = vec![0_u8; width * height];
    let rows = ROWS_PER_TAP * kernel.len();
    let bands = blurred.par_chunks_mut(width * rows).enumerate();
    bands.for_each(|(band, out)| blur_band(picture.as_raw(), band * rows, &kernel, out, width));
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

/// Blurs the rows from `first` on that `out` has room for. As many rows blurred along themselves as the kernel has weights are kept: they fit
/// the cache of a core.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn blur_band(values: &[u8], first: usize, kernel: &[f32], out: &mut [u8], width: usize) {
    let (height, radius) = (values.len() / width, kernel.len() / 2);
    let mut padded = vec![0.0; width + 2 * radius];
    let mut sums = vec![0.0; width];
    // Row y is at y modulo their number.
    let mut across = vec![0.0; kernel.len() * width];
    let mut next = first.saturating_sub(radius);
    for (y, out) in (first..).zip(out.chunks_exact_mut(width)) {
        while next < height && next <= y + radius {
            let target = &mut across[next % kernel.len() * width..][..width];
            blur_rows(&values[next * width..][..width], kernel, &mut padded, target);
            next += 1;
        }
        let place = |offset: usize| (y + offset).saturating_sub(radius).min(height - 1) % kernel.len();
        blur_columns(&across, place, kernel, &mut sums, out);
    }
}

/// Blurs along the rows: one row, with room for its values and those repeated on both sides.
#[inline(always)]
fn blur_rows(row: &[u8], kernel: &[f32], padded: &mut [f32], out: &mut [f32]) {
    let radius = kernel.len() / 2;
    padded[..radius].fill(f32::from(row[0]));
    padded[radius + row.len()..].fill(f32::from(row[row.len() - 1]));
    for (padded, &value) in padded[radius..].iter_mut().zip(row) {
        *padded = f32::from(value);
    }
    out.fill(0.0);
    for (offset, &weight) in kernel.iter().enumerate() {
        for (sum, &value) in out.iter_mut().zip(&padded[offset..]) {
            *sum += weight * value;
        }
    }
}

/// Blurs along the columns: one row, from rows whose place among those kept `place` tells for each weight of the kernel, with room for sums.
#[inline(always)]
fn blur_columns(
    across: &[f32],
    place: impl Fn(usize) -> usize,
    kernel: &[f32],
    sums: &mut [f32],
    out: &mut [u8],
) {
    let width = out.len();
    // Half a level, since the fraction is cut off.
    sums.fill(0.5);
    for (offset, &weight) in kernel.iter().enumerate() {
        for (sum, &value) in sums.iter_mut().zip(&across[place(offset) * width..][..width]) {
            *sum += weight * value;
        }
    }
    for (out, &sum) in out.iter_mut().zip(&*sums) {
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
        fn agrees_with_the_plain_sum(
            height in 1..60_u32, values in prop::collection::vec(any::<u8>(), 13 * 60), sigma in 0.3..2.5_f64,
        ) {
            // Of one band, and of several.
            let picture = GrayImage::from_raw(13, height, values[..13 * height as usize].to_vec()).unwrap();
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
