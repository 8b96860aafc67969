//! Conversion of log-weights to probabilities, without overflow.

/// Returns the normalised weights, exp(log wᵢ) / Σ exp(log wⱼ), by subtracting the largest first. Log-weights of NaN or −∞
/// give zero; if none is usable, all particles get the same weight.
pub fn normalise(log_weights: &[f64]) -> Vec<f64> {
    let usable = |&value: &f64| if value.is_nan() { f64::NEG_INFINITY } else { value };
    let largest = log_weights.iter().map(usable).fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return vec![1.0 / log_weights.len().max(1) as f64; log_weights.len()];
    }
    let mut weights: Vec<f64> = log_weights.iter().map(|value| (usable(value) - largest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    weights
}

/// Returns the effective sample size of normalised weights, 1/Σ wᵢ² (Kong, Liu and Wong, 1994).
pub fn effective_sample_size(weights: &[f64]) -> f64 {
    let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
    if squares > 0.0 { 1.0 / squares } else { 0.0 }
}

/// Returns the index of the largest log-weight, the first of equals; ignores NaN.
pub fn best_index(log_weights: &[f64]) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (index, &value) in log_weights.iter().enumerate() {
        if !value.is_nan() && best.is_none_or(|(_, largest)| value > largest) {
            best = Some((index, value));
        }
    }
    best.map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_log_weight() -> impl Strategy<Value = f64> {
        prop_oneof![-1e308..1e308, -10.0..10.0, Just(f64::NAN), Just(f64::NEG_INFINITY), Just(0.0)]
    }

    proptest! {
        #[test]
        fn weights_are_probabilities_whatever_the_sums(log_weights in prop::collection::vec(any_log_weight(), 1..50)) {
            let weights = normalise(&log_weights);
            prop_assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let size = effective_sample_size(&weights);
            prop_assert!(size >= 1.0 - 1e-9 && size <= weights.len() as f64 + 1e-6);
        }

        #[test]
        fn a_common_offset_changes_nothing(log_weights in prop::collection::vec(-50.0..50.0, 1..50), offset in -1e6..1e6) {
            let moved: Vec<f64> = log_weights.iter().map(|value| value + offset).collect();
            for (a, b) in normalise(&log_weights).iter().zip(normalise(&moved)) {
                prop_assert!((a - b).abs() < 1e-8);
            }
        }
    }
}
