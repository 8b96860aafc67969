//! Robust statistics of samples (Huber, "Robust Statistics", 1981).

/// Ratio of a normal distribution's standard deviation to its median absolute deviation.
const SIGMA_PER_ABSOLUTE_MEDIAN: f64 = 1.4826;

/// Returns the median. Of an even number of values it is the upper of the two in the middle, of no values 0.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Returns the standard deviation about zero, from the median of the absolute values.
pub fn robust_sigma(values: impl IntoIterator<Item = f64>) -> f64 {
    SIGMA_PER_ABSOLUTE_MEDIAN * median(values.into_iter().map(f64::abs))
}

/// Residual, in standard deviations, from which Tukey's biweight gives no weight: with it a fit to normal errors keeps 95 % of the
/// efficiency of least squares.
pub const TUKEY: f64 = 4.685;

/// Returns the weight that Tukey's biweight gives a residual in standard deviations, from 1 for none to 0 beyond [`TUKEY`].
pub fn tukey_weight(error_in_sigmas: f64) -> f64 {
    let ratio = error_in_sigmas / TUKEY;
    if ratio.abs() < 1.0 { (1.0 - ratio * ratio).powi(2) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_value_or_the_upper_one_of_two() {
        assert_eq!(median([5.0, -1.0, 3.0]), 3.0);
        assert_eq!(median([4.0, 1.0, 3.0, 2.0]), 3.0);
        assert_eq!(median([]), 0.0);
    }

    #[test]
    fn the_quartile_of_a_normal_distribution_gives_its_standard_deviation() {
        // Half of a standard normal distribution lies within 0.674 49 of zero.
        let quartile = 0.674_49;
        let sigma = robust_sigma([-2.0, -quartile, -0.1, 0.2, 3.0]);
        assert!((sigma - 1.0).abs() < 1e-4, "{sigma}");
    }
}
