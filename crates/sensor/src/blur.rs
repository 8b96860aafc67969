//! The point spread function: light that falls beside its pixel.
//!
//! The kernel is that of heat diffusing along a line of pixels. Its variance is exactly the requested one, even for
//! fractions of a pixel, and its form approaches a Gaussian (Lindeberg, "Scale-space for discrete signals", PAMI 1990). It
//! is applied along the rows, then along the columns.

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use crate::light::Light;

/// Least number of diffusion steps.
const LEAST_STEPS: usize = 16;
/// Reach of a kernel in standard deviations: pixels beyond it receive next to no light.
const REACH_SIGMAS: f64 = 5.0;
/// Variance in pixels² above which kernels are sampled Gaussians: diffusion would take too many steps.
const HEAT_PX2: f64 = 100.0;
/// Longest reach of a kernel in pixels: pictures end before that.
const LONGEST_REACH: usize = 4096;

/// Returns the picture blurred at each pixel by the variance there, in pixels² along each axis. Beyond the picture's sides,
/// the light continues with the values at the sides.
pub(crate) fn blurred(light: Light, variance_px2: impl Fn(DVec2) -> f64 + Sync) -> Light {
    let mut across = light.clone();
    across.rows_mut().zip(light.rows()).enumerate().for_each(|(v, (row, source))| {
        let at = |u: isize| source[u.clamp(0, source.len() as isize - 1) as usize];
        blur_row(row, v, &variance_px2, |u, offset| at(u as isize + offset));
    });
    let mut both = light;
    both.rows_mut().enumerate().for_each(|(v, row)| {
        blur_row(row, v, &variance_px2, |u, offset| across.nearest_row(v as isize + offset)[u]);
    });
    both
}

/// Blurs one row of the output; `source` gives the light at a pixel of the row, offset along the direction of the blur.
fn blur_row(
    row: &mut [Vec3],
    v: usize,
    variance_px2: impl Fn(DVec2) -> f64,
    source: impl Fn(usize, isize) -> Vec3,
) {
    let mut kernel = Kernel::new(0.0);
    for (u, pixel) in row.iter_mut().enumerate() {
        let variance_px2 = variance_px2(DVec2::new(u as f64, v as f64));
        if variance_px2 != kernel.variance_px2 {
            kernel = Kernel::new(variance_px2);
        }
        *pixel = kernel.weigh(|offset| source(u, offset));
    }
}

/// Returns the weights of a pixel and of its neighbours on one side for a blur of this variance, pixels² along an axis.
pub(crate) fn weights(variance_px2: f64) -> Vec<f32> {
    Kernel::new(variance_px2).weights
}

/// Weights of a pixel and of its neighbours on one side; the other side mirrors them.
struct Kernel {
    variance_px2: f64,
    weights: Vec<f32>,
}

impl Kernel {
    fn new(variance_px2: f64) -> Self {
        let weights = if variance_px2 > HEAT_PX2 { gaussian(variance_px2) } else { heat(variance_px2) };
        let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
        Self { variance_px2, weights: weights.into_iter().map(|weight| (weight / sum) as f32).collect() }
    }

    fn weigh(&self, at: impl Fn(isize) -> Vec3) -> Vec3 {
        let sides = self.weights.iter().enumerate().skip(1);
        sides.fold(self.weights[0] * at(0), |sum, (offset, weight)| {
            sum + weight * (at(offset as isize) + at(-(offset as isize)))
        })
    }
}

/// Returns the share of heat left in a pixel after diffusing to this variance, followed by the shares of its neighbours.
fn heat(variance_px2: f64) -> Vec<f64> {
    let steps = LEAST_STEPS.max((2.0 * variance_px2).ceil() as usize);
    // Each step moves this share of the light by one pixel to either side.
    let share = variance_px2 / (2.0 * steps as f64);
    let reach = (1 + (REACH_SIGMAS * variance_px2.sqrt()).ceil() as usize).min(steps);
    let mut weights = vec![0.0; reach + 2];
    weights[0] = 1.0;
    for _ in 0..steps {
        let before = weights.clone();
        for offset in 0..=reach {
            let inner = before[offset.abs_diff(1)];
            weights[offset] += share * (inner - 2.0 * before[offset] + before[offset + 1]);
        }
    }
    weights.truncate(reach + 1);
    weights
}

fn gaussian(variance_px2: f64) -> Vec<f64> {
    let reach = ((REACH_SIGMAS * variance_px2.sqrt()).ceil() as usize).min(LONGEST_REACH);
    (0..=reach).map(|offset| (-0.5 * (offset * offset) as f64 / variance_px2).exp()).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn kernels_have_their_variance_and_lose_no_light(variance_px2 in 0.0f64..30.0) {
            let kernel = Kernel::new(variance_px2);
            let weights = kernel.weights.iter().map(|weight| f64::from(*weight));
            let sum = 2.0 * weights.clone().sum::<f64>() - f64::from(kernel.weights[0]);
            let second: f64 = weights.enumerate().map(|(offset, weight)| 2.0 * weight * (offset * offset) as f64).sum();
            prop_assert!((sum - 1.0).abs() < 1e-5);
            prop_assert!((second - variance_px2).abs() < 1e-3 * variance_px2 + 1e-6, "{second}");
        }
    }

    #[test]
    fn the_sampled_gaussian_continues_the_diffusion_kernel() {
        let [heat, gaussian] = [HEAT_PX2, HEAT_PX2 + 1e-6].map(Kernel::new);
        for (heat, gaussian) in heat.weights.iter().zip(&gaussian.weights) {
            assert!((heat - gaussian).abs() < 2e-4, "{heat} {gaussian}");
        }
        assert_eq!(Kernel::new(1e12).weights.len(), LONGEST_REACH + 1);
    }

    #[test]
    fn wide_kernels_are_gaussian() {
        let kernel = Kernel::new(9.0);
        for (offset, weight) in kernel.weights.iter().enumerate() {
            let gaussian = (-((offset * offset) as f64) / 18.0).exp() / (18.0 * std::f64::consts::PI).sqrt();
            assert!((f64::from(*weight) - gaussian).abs() < 2e-3, "{offset}: {weight} {gaussian}");
        }
    }
}
