//! Significance tests: Student's t for a single number, Hotelling's T² for several.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// Two-sided p-value of a number that is `score` standard deviations from zero. `degrees` is the number of degrees of
/// freedom of the scatter that the standard deviation was estimated from.
pub(crate) fn two_sided(score: f64, degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.max(1.0)).map_or(1.0, |student| 2.0 * student.sf(score.abs()))
}

/// Quantile of Student's t-distribution.
pub(crate) fn student_quantile(probability: f64, degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.max(1.0))
        .map_or(f64::INFINITY, |student| student.inverse_cdf(probability))
}

/// P-value of estimates that are jointly as far from zero as these (Hotelling's T²). If the covariance of `n` numbers was
/// estimated from `count` clusters, `T² (count − n) / (n (count − 1))` is F-distributed with n and count − n degrees of
/// freedom. Returns 1 without numbers, or with too few clusters for them.
pub(crate) fn hotelling_p_value(covariance: &DMatrix<f64>, estimates: &DVector<f64>, count: usize) -> f64 {
    let number = estimates.len();
    if number == 0 || count <= number + 1 {
        return 1.0;
    }
    let Some(squared) = squared_distance(covariance, estimates) else { return 1.0 };
    let degrees = (count - number) as f64;
    let statistic = squared * degrees / (number as f64 * (count - 1) as f64);
    match FisherSnedecor::new(number as f64, degrees) {
        Ok(distribution) if statistic.is_finite() && statistic > 0.0 => distribution.sf(statistic),
        _ => 1.0,
    }
}

/// Squared Mahalanobis distance `vᵀ C⁻¹ v`. The covariance of parameters with nearly the same effect is almost singular, so
/// 1e-9 is added to the diagonal of the correlation matrix.
fn squared_distance(covariance: &DMatrix<f64>, value: &DVector<f64>) -> Option<f64> {
    let scale = covariance.diagonal().map(|variance| variance.max(f64::MIN_POSITIVE).sqrt());
    let size = value.len();
    let correlation = DMatrix::from_fn(size, size, |i, j| {
        let both = 0.5 * (covariance[(i, j)] + covariance[(j, i)]) / (scale[i] * scale[j]);
        if i == j { both + 1e-9 } else { both }
    });
    let scaled = value.component_div(&scale);
    Some(scaled.dot(&correlation.cholesky()?.solve(&scaled)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_is_tested_alike_by_hotelling_and_by_student() {
        let (variance, estimate, count) = (0.09, 0.7, 16);
        let covariance = DMatrix::from_element(1, 1, variance);
        let hotelling = hotelling_p_value(&covariance, &DVector::from_element(1, estimate), count);
        let student = two_sided(estimate / f64::sqrt(variance), (count - 1) as f64);
        assert!((hotelling / student - 1.0).abs() < 1e-6, "{hotelling} {student}");
    }

    #[test]
    fn a_score_at_the_quantile_has_the_quantiles_probability() {
        let score = student_quantile(0.975, 9.0);
        assert!((two_sided(score, 9.0) - 0.05).abs() < 1e-9);
        assert_eq!(two_sided(score, 9.0), two_sided(-score, 9.0));
    }

    #[test]
    fn too_few_clusters_for_the_numbers_give_a_p_value_of_one() {
        let covariance = DMatrix::identity(3, 3);
        assert_eq!(hotelling_p_value(&covariance, &DVector::from_element(3, 9.0), 4), 1.0);
        assert!(hotelling_p_value(&covariance, &DVector::from_element(3, 9.0), 9) < 0.01);
        assert_eq!(hotelling_p_value(&DMatrix::zeros(0, 0), &DVector::zeros(0), 9), 1.0);
    }
}
