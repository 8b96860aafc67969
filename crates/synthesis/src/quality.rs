//! How near a picture comes to the true one: PSNR and SSIM.

use glam::DVec2;
use image::{GrayImage, RgbImage};
use rayon::prelude::*;
use reality_sim_core::{camera::Camera, field::FieldDimensions, pose::CameraPose};

/// Identical pictures have this PSNR, dB: that of an error of a hundredth of a grey level.
pub const MAX_PSNR_DB: f64 = 88.13;

/// Pixels that are compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask {
    width: u32,
    chosen: Vec<bool>,
}

impl Mask {
    /// The pixels that look at the field's carpet, or at what stands on it in front.
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

    /// Number of pixels.
    pub fn count(&self) -> usize {
        self.chosen.iter().filter(|chosen| **chosen).count()
    }
}

/// Peak signal-to-noise ratio, dB: 10 log₁₀(255² / mean squared error over all pixels and channels), or over the pixels
/// chosen. `None` where there are none, or the sizes differ.
pub fn psnr_db(picture: &RgbImage, truth: &RgbImage, mask: Option<&Mask>) -> Option<f64> {
    if picture.dimensions() != truth.dimensions() || mask.is_some_and(|mask| mask.width != picture.width()) {
        return None;
    }
    let (mut sum, mut count) = (0.0, 0_u64);
    for (index, (a, b)) in picture.pixels().zip(truth.pixels()).enumerate() {
        if mask.is_none_or(|mask| mask.chosen.get(index) == Some(&true)) {
            let squares = a.0.iter().zip(b.0).map(|(&a, b)| (f64::from(a) - f64::from(b)).powi(2));
            sum += squares.sum::<f64>();
            count += 3;
        }
    }
    (count > 0).then(|| (10.0 * (255.0 * 255.0 * count as f64 / sum).log10()).min(MAX_PSNR_DB))
}

/// Structural similarity of the grey values (Wang et al., 2004): Gaussian window of σ = 1.5 px and 11 px, K₁ = 0.01,
/// K₂ = 0.03, the mean over all pixels whose window lies inside. `None` for other sizes, or smaller pictures.
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

/// Gaussian of 11 px and σ = 1.5 px, where the whole window lies inside.
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
