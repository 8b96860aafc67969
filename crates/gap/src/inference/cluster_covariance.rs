//! Scatter of a fit's scores between clusters of frames: the middle factor of a cluster-robust (sandwich) covariance.
//!
//! With the clusters' scores `sᵢ = gᵢ − Aᵢ δ`, the covariance of a fit with information `A` is `A⁻¹ M A⁻¹` (White 1980). For
//! independent clusters, `M = Σ sᵢ sᵢᵀ`. If neighbouring clusters are correlated, their products count as well, with
//! Bartlett's weights `1 − lag / (L + 1)` (Newey and West, Econometrica 55, 1987).

use nalgebra::{DMatrix, DVector};

use crate::thresholds::Thresholds;

/// Largest lag at which successive clusters are taken to be correlated.
pub(crate) const LAG: usize = Thresholds::DEFAULT.inference.correlated_clusters;

/// Returns `Σ sᵢ sᵢᵀ` of clusters in order of time, plus the products of neighbours with Bartlett's weights.
pub(crate) fn of_neighbours(scores: &[DVector<f64>], size: usize) -> DMatrix<f64> {
    let mut scatter = DMatrix::zeros(size, size);
    for (index, score) in scores.iter().enumerate() {
        scatter.ger(1.0, score, score, 1.0);
        for lag in 1..=LAG.min(index) {
            let weight = 1.0 - lag as f64 / (LAG + 1) as f64;
            scatter.ger(weight, score, &scores[index - lag], 1.0);
            scatter.ger(weight, &scores[index - lag], score, 1.0);
        }
    }
    scatter * small_sample_factor(scores.len())
}

/// Returns `Σ sᵢ sᵢᵀ` of mutually independent clusters.
pub(crate) fn of_independent(scores: &[DVector<f64>], size: usize) -> DMatrix<f64> {
    let mut scatter = DMatrix::zeros(size, size);
    for score in scores {
        scatter.ger(1.0, score, score, 1.0);
    }
    scatter * small_sample_factor(scores.len())
}

/// Returns `n / (n − 1)`, which corrects for the mean that a fit removes from the scores of n clusters.
fn small_sample_factor(count: usize) -> f64 {
    let count = count as f64;
    count / (count - 1.0).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scores(values: &[f64]) -> Vec<DVector<f64>> {
        values.iter().map(|value| DVector::from_element(1, *value)).collect()
    }

    #[test]
    fn products_of_neighbours_count_with_weights_that_fall_to_zero_beyond_the_lag() {
        let pair = |distance: usize| {
            let mut values = vec![0.0; 8];
            (values[0], values[distance]) = (1.0, 1.0);
            of_neighbours(&scores(&values), 1)[(0, 0)] * 7.0 / 8.0
        };
        for (distance, wanted) in [(1, 3.5), (2, 3.0), (3, 2.5), (4, 2.0)] {
            assert!((pair(distance) - wanted).abs() < 1e-12, "{distance}: {}", pair(distance));
        }
    }

    #[test]
    fn independent_clusters_count_alone() {
        assert_eq!(of_independent(&scores(&[1.0, 2.0, 3.0]), 1)[(0, 0)], 14.0 * 1.5);
    }
}
