//! Significance tests: Student's t for a single number, Hotelling's T² for several.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

use crate::inference::cluster_covariance::LAG;

/// Two-sided p-value of a number that is `score` standard deviations from zero. `degrees` is the number of degrees of
/// freedom of the scatter that the standard deviation was estimated from.
pub(crate) fn two_sided(score: f64, degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.max(1.0)).map_or(1.0, |student| 2.0 * student.sf(score.abs()))
}

/// Two-sided p-value of a sum over successive frames, which may be correlated. `deviations` are the terms of the sum about their
/// mean.
///
/// The long-run variance is the mean square of the first cosine transforms of the deviations, and the ratio of the sum to it has
/// Student's t-distribution with as many degrees of freedom as there are transforms: exactly so for independent normal terms of
/// equal variance, however few, and nearly so where terms are correlated over fewer frames than half the period of the last
/// transform, which is four frames (Müller, Econometrica 75, 2007; Lazarus, Lewis, Stock and Watson, Journal of Business &
/// Economic Statistics 36, 2018).
pub(crate) fn series_p_value(sum: f64, deviations: &[f64]) -> f64 {
    let count = deviations.len() as f64;
    let transforms = (deviations.len() / 2).max(1);
    let transform = |order: usize| {
        let cosine = |index: usize| (PI * order as f64 * (index as f64 + 0.5) / count).cos();
        (2.0 / count).sqrt() * (0..).zip(deviations).map(|(index, value)| value * cosine(index)).sum::<f64>()
    };
    let mean_square = (1..=transforms).map(|order| transform(order).powi(2)).sum::<f64>() / transforms as f64;
    two_sided(sum / (count * mean_square).sqrt().max(1e-12), transforms as f64)
}

/// Factor by which a standard deviation of Bartlett's kernel over this number of correlated clusters has to be multiplied, so that
/// 1.96 of it make a 95 % interval: the kernel finds too small a variance in few clusters, and one that scatters (Kiefer and
/// Vogelsang, Econometric Theory 21, 2005, table 1, for the kernel's width as a part of the number of clusters).
pub(crate) fn bartlett_interval_factor(clusters: usize) -> f64 {
    let width = ((LAG + 1) as f64 / clusters.max(1) as f64).min(1.0);
    (1.96 + 2.9694 * width + 0.4160 * width * width - 0.5324 * width.powi(3)) / 1.96
}

/// The same factor for a standard deviation from independent clusters, by Student's t.
pub(crate) fn independent_interval_factor(clusters: usize) -> f64 {
    let degrees = clusters.saturating_sub(1).max(1) as f64;
    StudentsT::new(0.0, 1.0, degrees).map_or(f64::INFINITY, |student| student.inverse_cdf(0.975)) / 1.96
}

/// Degrees of freedom of a variance by Bartlett's kernel over this number of correlated clusters (Kiefer and Vogelsang 2005: about
/// 1.5 times the number of clusters over the kernel's width).
pub(crate) fn bartlett_degrees(clusters: usize) -> usize {
    3 * clusters / (2 * (LAG + 1))
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

/// P-value of estimates that are about as large as these `wanted` numbers, beside no multiple of them: their projection in the
/// metric of the covariance, which was estimated from `count` clusters. 1 if they are larger or smaller by more than this `factor`.
pub(crate) fn multiple_p_value(
    covariance: &DMatrix<f64>,
    estimates: &DVector<f64>,
    wanted: &DVector<f64>,
    factor: f64,
    count: usize,
) -> f64 {
    let Some((projected, squared)) =
        product(covariance, estimates, wanted).zip(squared_distance(covariance, wanted))
    else {
        return 1.0;
    };
    let score = projected / squared.sqrt();
    if score > 0.0 && (projected / squared).ln().abs() < factor.ln() {
        hotelling_p_value(&DMatrix::identity(1, 1), &DVector::from_element(1, score), count)
    } else {
        1.0
    }
}

/// Squared Mahalanobis distance `vᵀ C⁻¹ v`.
fn squared_distance(covariance: &DMatrix<f64>, value: &DVector<f64>) -> Option<f64> {
    product(covariance, value, value)
}

/// Product `aᵀ C⁻¹ b`. The covariance of parameters with nearly the same effect is almost singular, so 1e-9 is added to the
/// diagonal of the correlation matrix.
fn product(covariance: &DMatrix<f64>, a: &DVector<f64>, b: &DVector<f64>) -> Option<f64> {
    let scale = covariance.diagonal().map(|variance| variance.max(f64::MIN_POSITIVE).sqrt());
    let size = a.len();
    let correlation = DMatrix::from_fn(size, size, |i, j| {
        let both = 0.5 * (covariance[(i, j)] + covariance[(j, i)]) / (scale[i] * scale[j]);
        if i == j { both + 1e-9 } else { both }
    });
    let [a, b] = [a, b].map(|value| value.component_div(&scale));
    Some(a.dot(&correlation.cholesky()?.solve(&b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    #[test]
    fn sums_of_noise_over_few_frames_are_as_rarely_significant_as_their_p_value_says() {
        const DRAWS: usize = 200_000;
        for frames in [6, 12, 45] {
            let mut noise = Noise(frames as u64);
            let p_values: Vec<f64> = (0..DRAWS)
                .map(|_| {
                    let values: Vec<f64> = (0..frames).map(|_| noise.next()).collect();
                    let sum: f64 = values.iter().sum();
                    let deviations: Vec<f64> =
                        values.iter().map(|value| value - sum / frames as f64).collect();
                    series_p_value(sum, &deviations)
                })
                .collect();
            for level in [1e-2, 1e-3, 1e-4] {
                let ratio = p_values.iter().filter(|p| **p < level).count() as f64 / (DRAWS as f64 * level);
                assert!((1.0 / 1.5..1.5).contains(&ratio), "{frames} frames, {level}: {ratio}");
            }
        }
    }

    #[test]
    fn sums_of_noise_that_neighbours_share_are_seldom_significant() {
        let mut noise = Noise(1);
        let false_alarms = (0..20_000).filter(|_| {
            let mut last = noise.next();
            let mut next = || {
                last = 0.3 * last + noise.next();
                last
            };
            let values: Vec<f64> = (0..45).map(|_| next()).collect();
            let sum: f64 = values.iter().sum();
            let deviations: Vec<f64> = values.iter().map(|value| value - sum / 45.0).collect();
            series_p_value(sum, &deviations) < 1e-2
        });
        let ratio = false_alarms.count() as f64 / 200.0;
        assert!(ratio < 3.0, "{ratio}");
    }

    #[test]
    fn one_number_is_tested_alike_by_hotelling_and_by_student() {
        let (variance, estimate, count) = (0.09, 0.7, 16);
        let covariance = DMatrix::from_element(1, 1, variance);
        let hotelling = hotelling_p_value(&covariance, &DVector::from_element(1, estimate), count);
        let student = two_sided(estimate / f64::sqrt(variance), (count - 1) as f64);
        assert!((hotelling / student - 1.0).abs() < 1e-6, "{hotelling} {student}");
    }

    #[test]
    fn too_few_clusters_for_the_numbers_give_a_p_value_of_one() {
        let covariance = DMatrix::identity(3, 3);
        assert_eq!(hotelling_p_value(&covariance, &DVector::from_element(3, 9.0), 4), 1.0);
        assert!(hotelling_p_value(&covariance, &DVector::from_element(3, 9.0), 9) < 0.01);
        assert_eq!(hotelling_p_value(&DMatrix::zeros(0, 0), &DVector::zeros(0), 9), 1.0);
    }

    #[test]
    fn estimates_are_tested_along_what_is_wanted_and_where_they_are_about_as_large() {
        let covariance = DMatrix::from_row_slice(2, 2, &[0.04, 0.01, 0.01, 0.09]);
        let wanted = DVector::from_vec(vec![1.0, -0.5]);
        let p_value = |estimates: DVector<f64>| multiple_p_value(&covariance, &estimates, &wanted, 1.5, 200);
        // Along what is wanted the test is that of one number, which is more powerful than that of two.
        let along = 0.7 * &wanted;
        assert!(p_value(along.clone()) < 0.7 * hotelling_p_value(&covariance, &along, 200));
        assert_eq!(p_value(-along), 1.0);
        // What is much larger or much smaller is something else, however significant.
        assert!(p_value(1.4 * &wanted) < 1e-3);
        assert_eq!([p_value(1.6 * &wanted), p_value(0.6 * &wanted)], [1.0; 2]);
        // An estimate that is orthogonal to it in the metric of the covariance says nothing.
        let across = &covariance * DVector::from_vec(vec![0.5, 1.0]) * 30.0;
        assert!(p_value(across.clone()) > 0.9 && hotelling_p_value(&covariance, &across, 200) < 1e-6);
    }
}
