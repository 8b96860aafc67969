//! Similarity of a picture to the true one: PSNR and SSIM.

use glam::DVec2;
use image::{GrayImage, RgbImage};
use rayon::prelude::*;
use reality_sim_core::{camera::Camera, field::FieldDimensions, pose::CameraPose};

/// PSNR of identical pictures, dB: that of an error of one hundredth of a grey level.
pub const MAX_PSNR_DB: f64 = 88.13;

/// Set of pixels to compare.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask {
    width: u32,
    chosen: Vec<bool>,
}

impl Mask {
    /// Returns the pixels that show the field's carpet, or objects in front of it.
    pub fn carpet(camera: &Camera, pose: CameraPose, field: &FieldDimensions) -> Self {
        let half = field.carpet_half_extent_m();
        let rows = (0..camera.height).into_par_iter().flat_map_iter(|v| {
            (0..camera.width).map(move |u| {
                let pixel = DVec2::new(f64::from(u), f64::from(v));
                let point = camera.unproject_to_ground(pose, pixel);
                camera.check_inside(pixel).is_ok() && point.is_ok_and(|point| point.abs().cmple(half).all())
            })
        });
        Self { width: camera.width, chosen: rows.collect() }
    }

    /// Returns whether a pixel, counted row by row from the top, is one of them.
    pub fn holds(&self, pixel: usize) -> bool {
        self.chosen.get(pixel) == Some(&true)
    }

    /// Number of pixels.
    pub fn count(&self) -> usize {
        self.chosen.iter().filter(|chosen| **chosen).count()
    }
}

/// Peak signal-to-noise ratio, dB: 10 log₁₀(255² / mean squared error over all pixels and channels), or over the chosen
/// pixels only. `None` if there are no pixels, or the sizes differ.
pub fn psnr_db(picture: &RgbImage, truth: &RgbImage, mask: Option<&Mask>) -> Option<f64> {
    if picture.dimensions() != truth.dimensions() || mask.is_some_and(|mask| mask.width != picture.width()) {
        return None;
    }
    let (mut sum, mut count) = (0.0, 0_u64);
    for (index, (a, b)) in picture.pixels().zip(truth.pixels()).enumerate() {
        if mask.is_none_or(|mask| mask.holds(index)) {
            let squares = a.0.iter().zip(b.0).map(|(&a, b)| (f64::from(a) - f64::from(b)).powi(2));
            sum += squares.sum::<f64>();
            count += 3;
        }
    }
    (count > 0).then(|| (10.0 * (255.0 * 255.0 * count as f64 / sum).log10()).min(MAX_PSNR_DB))
}

/// Structural similarity of the grey values (Wang et al., 2004): Gaussian window of 11 px with σ = 1.5 px, K₁ = 0.01, K₂ =
/// 0.03, averaged over all pixels whose window lies inside. `None` if the sizes differ, or the pictures are smaller than a
/// window.
pub fn ssim(picture: &GrayImage, truth: &GrayImage) -> Option<f64> {
    const WINDOW: usize = 11;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if picture.dimensions() != truth.dimensions() || width < WINDOW || height < WINDOW {
        return None;
    }
    let a: Vec<f64> = picture.iter().map(|&grey| f64::from(grey)).collect();
    let b: Vec<f64> = truth.iter().map(|&grey| f64::from(grey)).collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
    let inputs = [a.clone(), b.clone(), product(&a, &a), product(&b, &b), product(&a, &b)];
    let windowed: Vec<Vec<f64>> = inputs.par_iter().map(|values| gauss(values, width, height)).collect();
    let (c1, c2) = ((0.01_f64 * 255.0).powi(2), (0.03_f64 * 255.0).powi(2));
    let similarity = |i: usize| {
        let (mean_a, mean_b) = (windowed[0][i], windowed[1][i]);
        let (var_a, var_b) = (windowed[2][i] - mean_a * mean_a, windowed[3][i] - mean_b * mean_b);
        let covariance = windowed[4][i] - mean_a * mean_b;
        (2.0 * mean_a * mean_b + c1) * (2.0 * covariance + c2)
            / ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2))
    };
    let count = windowed[0].len();
    Some((0..count).map(similarity).sum::<f64>() / count as f64)
}

/// Filters with a Gaussian of 11 px and σ = 1.5 px where the whole window lies inside.
fn gauss(values: &[f64], width: usize, height: usize) -> Vec<f64> {
    const RADIUS: usize = 5;
    let weights: Vec<f64> =
        (0..=2 * RADIUS).map(|i| (-0.5 * ((i as f64 - RADIUS as f64) / 1.5).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let (inner_width, inner_height) = (width - 2 * RADIUS, height - 2 * RADIUS);
    let mut rows = Vec::with_capacity(inner_width * height);
    for row in values.chunks(width) {
        rows.extend(
            row.windows(2 * RADIUS + 1)
                .map(|window| window.iter().zip(&weights).map(|(v, w)| v * w).sum::<f64>() / total),
        );
    }
    let mut result = vec![0.0; inner_width * inner_height];
    for (v, line) in result.chunks_mut(inner_width).enumerate() {
        for (offset, weight) in weights.iter().enumerate() {
            let from = &rows[(v + offset) * inner_width..(v + offset + 1) * inner_width];
            line.iter_mut().zip(from).for_each(|(sum, value)| *sum += weight / total * value);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use image::{Luma, Rgb};

    use super::*;

    fn grey(value: impl Fn(u32, u32) -> u32) -> GrayImage {
        GrayImage::from_fn(64, 48, |u, v| Luma([(value(u, v) % 256) as u8]))
    }

    /// The expected value comes from scikit-image: `structural_similarity` with Gaussian weights, σ = 1.5 and population
    /// covariance.
    #[test]
    fn similarity_is_that_of_scikit_image() {
        let (a, b) = (grey(|u, v| 7 * u + 13 * v), grey(|u, v| 7 * u + 13 * v + (u * v) % 29));
        let found = ssim(&a, &b).unwrap();
        assert!((found - 0.671_750_209_451_642).abs() < 1e-9, "{found}");
        assert!((ssim(&a, &a).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(ssim(&a, &GrayImage::new(64, 47)), None);
        assert_eq!(ssim(&GrayImage::new(10, 48), &GrayImage::new(10, 48)), None, "smaller than the window");
    }

    #[test]
    fn a_constant_error_has_the_psnr_of_its_size_and_the_mask_chooses_the_pixels() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let camera =
            Camera::new([64, 48], [30.0, 30.0, 31.5, 23.5], reality_sim_core::camera::Distortion::Pinhole)
                .unwrap();
        let pose = CameraPose { height_m: 0.5, pitch_rad: 0.3, ..Default::default() };
        let mask = Mask::carpet(&camera, pose, &field);
        assert!(mask.count() > 100 && mask.count() < 64 * 48);
        let truth = RgbImage::from_pixel(64, 48, Rgb([100; 3]));
        // The pictures differ only above the horizon, which is in row 14.
        let sky = RgbImage::from_fn(64, 48, |_, v| if v < 14 { Rgb([0; 3]) } else { Rgb([110; 3]) });
        assert!((psnr_db(&sky, &truth, Some(&mask)).unwrap() - 20.0 * 25.5_f64.log10()).abs() < 1e-9);
        assert!(psnr_db(&sky, &truth, None).unwrap() < 15.0);
        assert_eq!(psnr_db(&truth, &truth, None), Some(MAX_PSNR_DB));
        assert_eq!(psnr_db(&truth, &RgbImage::new(64, 47), None), None);
    }
}
