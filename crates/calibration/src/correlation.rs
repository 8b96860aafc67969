//! How far along a line its errors stay alike.
//!
//! A lens that is not quite the model, paint that is not quite straight and light from one side move long pieces of a line the same
//! way: many measured points on such a piece tell no more than one. The number of points that count as one is the integrated
//! autocorrelation (Sokal, "Monte Carlo methods in statistical mechanics", 1997, section 3), summed as far as the
//! correlation is clear.

use crate::picture::Row;

/// Largest number of places between two points that are compared.
const LARGEST_LAG: usize = 80;

/// Correlation below which the sum ends: beyond, it is the noise of the estimate.
const CLEAR: f64 = 0.05;

/// Fewest pairs of points from which a correlation is estimated.
const LEAST_PAIRS: f64 = 200.0;

/// Sums over pairs of points on the same line, by the number of places between them.
#[derive(Debug, Clone)]
pub(crate) struct Correlation {
    products: Vec<f64>,
    pairs: Vec<f64>,
}

impl Default for Correlation {
    fn default() -> Self {
        Self { products: vec![0.0; LARGEST_LAG + 1], pairs: vec![0.0; LARGEST_LAG + 1] }
    }
}

impl Correlation {
    /// Adds the residuals of one picture, in the order of its rows; those beyond `largest_px` are left out: they are no lines.
    pub fn add(&mut self, rows: &[Row], residuals: &[f64], largest_px: f64) {
        let lag_sums = self.products.iter_mut().zip(&mut self.pairs).enumerate();
        for (lag, (product, pairs)) in lag_sums {
            for first in 0..rows.len().saturating_sub(lag) {
                let second = first + lag;
                let (a, b) = (residuals[first], residuals[second]);
                if rows[first].curve == rows[second].curve && a.abs() < largest_px && b.abs() < largest_px {
                    *product += a * b;
                    *pairs += 1.0;
                }
            }
        }
    }

    /// Returns how many points count as one, at least 1.
    pub fn points_that_count_as_one(&self) -> f64 {
        let covariance = |lag: usize| self.products[lag] / self.pairs[lag].max(1.0);
        let variance = covariance(0);
        let mut sum = 1.0;
        for lag in 1..=LARGEST_LAG {
            let correlation = covariance(lag) / variance;
            if self.pairs[lag] < LEAST_PAIRS || correlation.is_nan() || correlation < CLEAR {
                break;
            }
            sum += 2.0 * correlation;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use nalgebra::{DVector, Vector6};
    use reality_sim_core::filter::{Purpose, Stream};

    use super::*;

    fn row(curve: usize) -> Row {
        let (by_pose, by_parameters) = (Vector6::zeros(), DVector::zeros(0));
        Row { offset_px: 0.0, by_pose, by_parameters, pixel: DVec2::ZERO, curve }
    }

    /// For an autoregressive process with coefficient a, the answer is (1 + a) / (1 − a).
    #[test]
    fn points_of_an_autoregressive_process_count_as_known() {
        for (coefficient, expected) in [(0.0, 1.0), (0.5, 3.0), (0.9, 19.0)] {
            let mut correlation = Correlation::default();
            for picture in 0..60 {
                let stream = Stream::new(3, Purpose::Initialise, picture, 0);
                let (rows, mut value) = (vec![row(0); 400], 0.0_f64);
                let residuals: Vec<f64> = (0..400)
                    .map(|index| {
                        let fresh = stream.normals(index)[0];
                        value = coefficient * value + (1.0 - coefficient * coefficient).sqrt() * fresh;
                        value
                    })
                    .collect();
                correlation.add(&rows, &residuals, 10.0);
            }
            let found = correlation.points_that_count_as_one();
            assert!((found - expected).abs() < 0.15 * expected, "{found} instead of {expected}");
        }
    }
}
