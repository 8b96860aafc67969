//! Blur, from rays to pixels: a disc for defocus, then the lens's Gaussian and the pixel's own aperture.

use crate::rays::{Frame, PER_PIXEL};

/// Radius at which the Gaussian is cut, standard deviations.
const CUT: f64 = 4.0;

/// Point spread of a lens in focus, without the pixel's own aperture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSpread {
    /// Standard deviation per axis, of the core where there is a tail, pixels.
    pub sigma_px: f64,
    /// Shape.
    pub shape: Shape,
}

/// Shape of a point spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Gaussian.
    Gaussian,
    /// Evenly lit disc.
    Disc,
    /// Gaussian with a share of the light in a wider one.
    Tail {
        /// Share as a fraction.
        share: f64,
        /// Standard deviation of the tail, pixels.
        sigma_px: f64,
    },
}

impl PointSpread {
    /// Makes a Gaussian.
    pub fn gaussian(sigma_px: f64) -> Self {
        Self { sigma_px, shape: Shape::Gaussian }
    }

    /// Reduces light of one colour from a value per ray to a value per pixel.
    pub fn reduce(&self, light: &[f32], frame: Frame) -> Vec<f32> {
        match self.shape {
            Shape::Gaussian => reduce(light, frame, self.sigma_px),
            Shape::Disc => reduce_disc(light, frame, self.sigma_px),
            Shape::Tail { share, sigma_px } => {
                let mut sharp = reduce(light, frame, self.sigma_px);
                let veil = smoothed(&sharp, frame.size, sigma_px);
                sharp.iter_mut().zip(veil).for_each(|(sharp, veil)| *sharp += share as f32 * (veil - *sharp));
                sharp
            }
        }
    }
}

/// Returns a picture of one colour blurred by a Gaussian; beyond its rim there is no light, and none gets lost there.
pub fn smoothed(plane: &[f32], [columns, rows]: [usize; 2], sigma_px: f64) -> Vec<f32> {
    let reach = (CUT * sigma_px) as usize + 1;
    let kernel: Vec<f32> =
        (0..=reach).map(|place| (-0.5 * (place as f64 / sigma_px).powi(2)).exp() as f32).collect();
    let along = |length: usize, at: &dyn Fn(usize) -> f32, place: usize| {
        let range = place.saturating_sub(reach)..(place + reach + 1).min(length);
        let (mut sum, mut weights) = (0.0, 0.0);
        for other in range {
            let weight = kernel[other.abs_diff(place)];
            sum += weight * at(other);
            weights += weight;
        }
        sum / weights
    };
    let narrow: Vec<f32> = plane
        .chunks(columns)
        .flat_map(|row| (0..columns).map(move |column| along(columns, &|other| row[other], column)))
        .collect();
    let mut wide = vec![0.0; plane.len()];
    for (row, target) in wide.chunks_mut(columns).enumerate() {
        let range = row.saturating_sub(reach)..(row + reach + 1).min(rows);
        let weights: f32 = range.clone().map(|other| kernel[other.abs_diff(row)]).sum();
        for other in range {
            let weight = kernel[other.abs_diff(row)] / weights;
            let source = &narrow[other * columns..(other + 1) * columns];
            target.iter_mut().zip(source).for_each(|(target, value)| *target += weight * value);
        }
    }
    wide
}

/// Reduces light of one colour, a value per ray, to a value per pixel, spread over a disc of this standard deviation.
fn reduce_disc(light: &[f32], frame: Frame, sigma_px: f64) -> Vec<f32> {
    // The rays of a pixel are added up as points, and each stands for a cell.
    let cell = 1.0 / (12.0 * (PER_PIXEL * PER_PIXEL) as f64);
    let disc = disc_weights((sigma_px * sigma_px + cell).sqrt() * PER_PIXEL as f64);
    let side = disc.len() + PER_PIXEL - 1;
    let mut kernel = vec![vec![0.0_f32; side]; side];
    for (y, x) in (0..PER_PIXEL).flat_map(|y| (0..PER_PIXEL).map(move |x| (y, x))) {
        for (row, weights) in disc.iter().enumerate() {
            for (column, weight) in weights.iter().enumerate() {
                kernel[row + y][column + x] += weight / (PER_PIXEL * PER_PIXEL) as f32;
            }
        }
    }
    let first = frame.margin * PER_PIXEL + PER_PIXEL / 2 - side / 2;
    let width = frame.rays_per_row();
    let [columns, rows] = frame.size;
    let mut pixels = vec![0.0; columns * rows];
    for (row, pixels) in pixels.chunks_mut(columns).enumerate() {
        for (offset, weights) in kernel.iter().enumerate() {
            let source = &light[(first + row * PER_PIXEL + offset) * width + first..];
            for (pixel, source) in pixels.iter_mut().zip(source.windows(side).step_by(PER_PIXEL)) {
                *pixel += source.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f32>();
            }
        }
    }
    pixels
}

/// Returns the width of the margin around the picture from which light reaches it, pixels.
pub fn margin_px(psf_sigma_px: f64, defocus_px: f64) -> usize {
    // The 1 covers half a pixel and a ray.
    (1.0 + CUT * psf_sigma_px + 2.0 * defocus_px).ceil() as usize
}

/// Reduces light of one colour, a value per ray, to a value per pixel, spread by a Gaussian.
fn reduce(light: &[f32], frame: Frame, psf_sigma_px: f64) -> Vec<f32> {
    let kernel = pixel_kernel(psf_sigma_px);
    let width = frame.rays_per_row();
    let [columns, rows] = frame.size;
    let first = (frame.margin * PER_PIXEL + PER_PIXEL / 2) - kernel.len() / 2;
    let narrow: Vec<f32> = light
        .chunks(width)
        .flat_map(|row| {
            let kernel = &kernel;
            (0..columns).map(move |column| {
                let from = first + column * PER_PIXEL;
                row[from..from + kernel.len()]
                    .iter()
                    .zip(kernel)
                    .map(|(value, weight)| value * weight)
                    .sum::<f32>()
            })
        })
        .collect();
    let mut pixels = vec![0.0; columns * rows];
    for (row, pixels) in pixels.chunks_mut(columns).enumerate() {
        let from = first + row * PER_PIXEL;
        for (values, weight) in narrow.chunks(columns).skip(from).zip(&kernel) {
            pixels.iter_mut().zip(values).for_each(|(pixel, value)| *pixel += value * weight);
        }
    }
    pixels
}

/// Returns the weights of the rays around a pixel's centre: a Gaussian convolved with an aperture of one pixel. Each ray
/// stands for a square cell, whose variance is subtracted.
fn pixel_kernel(psf_sigma_px: f64) -> Vec<f32> {
    const APERTURE_STEPS: i32 = 60;
    let cell = 1.0 / (12.0 * (PER_PIXEL * PER_PIXEL) as f64);
    let sigma_px = (psf_sigma_px * psf_sigma_px - cell).max(cell).sqrt();
    let reach = ((0.5 + CUT * psf_sigma_px) * PER_PIXEL as f64) as i32;
    let weight = |index: i32| -> f64 {
        let place = f64::from(index) / PER_PIXEL as f64;
        let steps = 0..APERTURE_STEPS;
        steps
            .map(|step| {
                let distance = place + (f64::from(step) + 0.5) / f64::from(APERTURE_STEPS) - 0.5;
                (-0.5 * (distance / sigma_px).powi(2)).exp()
            })
            .sum()
    };
    let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| (weight / sum) as f32).collect()
}

/// Blurs light of one colour, a value per ray, by a disc of this standard deviation.
pub fn defocus(light: &[f32], frame: Frame, sigma_px: f64) -> Vec<f32> {
    let disc = disc_weights(sigma_px * PER_PIXEL as f64);
    let reach = disc.len() / 2;
    let width = frame.rays_per_row();
    let rows: Vec<&[f32]> = light.chunks(width).collect();
    let mut blurred = vec![0.0; light.len()];
    for (row, target) in blurred.chunks_mut(width).enumerate() {
        // Light from beyond the margin does not reach the picture.
        for (weights, source) in disc
            .iter()
            .zip(row..)
            .filter_map(|(weights, place)| Some((weights, rows.get(place.checked_sub(reach)?)?)))
        {
            for (column, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                add_shifted(target, source, column as i32 - reach as i32, *weight);
            }
        }
    }
    blurred
}

/// Adds to each ray's light a fraction of the light of the ray `shift` places further on.
fn add_shifted(target: &mut [f32], source: &[f32], shift: i32, weight: f32) {
    let (to, from) = ((-shift).max(0) as usize, shift.max(0) as usize);
    let pairs = target.iter_mut().skip(to).zip(&source[from..]);
    pairs.for_each(|(target, source)| *target += weight * source);
}

/// Returns the fraction of each square cell of one ray that a disc about the middle cell covers, in rows, normalised to a
/// sum of 1. The cells widen the disc by their own variance, which is subtracted.
fn disc_weights(sigma: f64) -> Vec<Vec<f32>> {
    const SLICES: i32 = 16;
    let radius = 2.0 * (sigma * sigma - 1.0 / 12.0).max(0.01).sqrt();
    let reach = (radius + 0.5) as i32;
    let covered = |row: i32, column: i32| -> f64 {
        let slices = (0..SLICES).map(|slice| {
            let y = f64::from(row) + (f64::from(slice) + 0.5) / f64::from(SLICES) - 0.5;
            let half = (radius * radius - y * y).max(0.0).sqrt();
            let (left, right) = (f64::from(column) - 0.5, f64::from(column) + 0.5);
            (right.min(half) - left.max(-half)).max(0.0)
        });
        slices.sum()
    };
    let cells = || -reach..=reach;
    let total: f64 =
        cells().flat_map(|row| cells().map(move |column| (row, column))).map(|(r, c)| covered(r, c)).sum();
    cells().map(|row| cells().map(|column| (covered(row, column) / total) as f32).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the sum, and the variances along x and y in square pixels, of the image of one lit pixel in the middle.
    fn moments(psf: PointSpread, defocus_px: f64) -> [f64; 3] {
        let frame = Frame { size: [21, 21], margin: margin_px(psf.sigma_px, defocus_px) };
        let mut light = vec![0.0; frame.rays_per_row() * frame.rows() * PER_PIXEL];
        let middle = (frame.margin + 10) * PER_PIXEL;
        for (row, column) in (0..PER_PIXEL).flat_map(|row| (0..PER_PIXEL).map(move |column| (row, column))) {
            light[(middle + row) * frame.rays_per_row() + middle + column] = 1.0;
        }
        if defocus_px > 0.0 {
            light = defocus(&light, frame, defocus_px);
        }
        let mut moments = [0.0; 3];
        for (index, value) in psf.reduce(&light, frame).iter().enumerate() {
            let (x, y) = ((index % 21) as f64 - 10.0, (index / 21) as f64 - 10.0);
            for (moment, weight) in moments.iter_mut().zip([1.0, x * x, y * y]) {
                *moment += f64::from(*value) * weight;
            }
        }
        [moments[0], moments[1] / moments[0], moments[2] / moments[0]]
    }

    #[test]
    fn a_point_becomes_the_gaussian_and_the_aperture() {
        let [sum, x, y] = moments(PointSpread::gaussian(0.5), 0.0);
        // The variances of the Gaussian, the aperture, and the lit pixel, whose rays stand for cells.
        let expected = 0.25 + 1.0 / 12.0 + 1.0 / 12.0 - 2.0 / 108.0;
        assert!((sum - 1.0).abs() < 0.01, "{sum}");
        assert!((x - expected).abs() < 0.005 && (y - expected).abs() < 0.005, "{x} {y}");
    }

    #[test]
    fn a_disc_and_a_gaussian_with_a_tail_have_their_variances() {
        let lit = 1.0 / 12.0 - 2.0 / 108.0 + 1.0 / 12.0;
        let disc = moments(PointSpread { sigma_px: 0.7, shape: Shape::Disc }, 0.0);
        let tail = Shape::Tail { share: 0.1, sigma_px: 1.5 };
        let tail = moments(PointSpread { sigma_px: 0.5, shape: tail }, 0.0);
        for ([sum, x, y], expected) in [(disc, 0.49 + lit), (tail, 0.25 + 0.1 * 2.25 + lit)] {
            assert!((sum - 1.0).abs() < 0.01, "{sum}");
            assert!((x - expected).abs() < 0.02 && (y - expected).abs() < 0.02, "{x} {y} {expected}");
        }
    }

    #[test]
    fn defocus_adds_its_variance_on_both_axes() {
        let [_, plain, _] = moments(PointSpread::gaussian(0.5), 0.0);
        for sigma_px in [0.3, 0.6, 1.3] {
            let [sum, x, y] = moments(PointSpread::gaussian(0.5), sigma_px);
            let added = [x - plain, y - plain].map(|added| added.sqrt() / sigma_px);
            assert!((sum - 1.0).abs() < 0.01, "{sum}");
            assert!(added.iter().all(|ratio| (ratio - 1.0).abs() < 0.03), "{sigma_px}: {added:?}");
        }
    }
}
