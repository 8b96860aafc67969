//! Choosing which particles survive, and how often. All schemes are unbiased: the expected number of copies of a
//! particle is the number asked for times its weight. Douc, Cappé and Moulines, "Comparison of resampling schemes for
//! particle filtering", 2005.

use serde::{Deserialize, Serialize};

use super::rng::Stream;

/// How survivors are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Resampling {
    /// ⌊n w⌋ copies for certain, the rest drawn from the remainders: the paper's.
    #[default]
    Residual,
    /// One random offset, then equal steps.
    Systematic,
    /// One random place in each of n equal strata.
    Stratified,
    /// n independent draws.
    Multinomial,
}

impl Resampling {
    /// Indices of `count` survivors, in ascending order for all schemes but residual and multinomial.
    pub fn choose(self, weights: &[f64], count: usize, stream: Stream) -> Vec<usize> {
        if weights.is_empty() {
            return Vec::new();
        }
        let n = count as f64;
        match self {
            Self::Systematic => {
                let offset = stream.uniform(0);
                inverse(weights, (0..count).map(|i| (i as f64 + offset) / n))
            }
            Self::Stratified => {
                inverse(weights, (0..count).map(|i| (i as f64 + stream.uniform(i as u32)) / n))
            }
            Self::Multinomial => inverse(weights, sorted_uniforms(count, stream).into_iter()),
            Self::Residual => residual(weights, count, stream),
        }
    }
}

/// Liu and Chen, "Sequential Monte Carlo methods for dynamic systems", 1998.
fn residual(weights: &[f64], count: usize, stream: Stream) -> Vec<usize> {
    let sum: f64 = weights.iter().sum();
    let copies = |weight: f64| (count as f64 * weight / sum).floor();
    let mut chosen = Vec::with_capacity(count);
    for (index, &weight) in weights.iter().enumerate() {
        chosen.extend(std::iter::repeat_n(index, (copies(weight) as usize).min(count - chosen.len())));
    }
    let left = count - chosen.len();
    if left > 0 {
        let rest: Vec<f64> =
            weights.iter().map(|&weight| count as f64 * weight / sum - copies(weight)).collect();
        chosen.extend(inverse(&rest, sorted_uniforms(left, stream).into_iter()));
    }
    chosen
}

fn sorted_uniforms(count: usize, stream: Stream) -> Vec<f64> {
    let mut uniforms: Vec<f64> = (0..count as u32).map(|i| stream.uniform(i)).collect();
    uniforms.sort_unstable_by(f64::total_cmp);
    uniforms
}

/// Inverse of the cumulative weights at ascending places in [0, 1).
fn inverse(weights: &[f64], places: impl Iterator<Item = f64>) -> Vec<usize> {
    let sum: f64 = weights.iter().sum();
    // Rounding may leave the last place beyond the last sum: the last particle with any weight takes it.
    let last = weights.iter().rposition(|&weight| weight > 0.0).unwrap_or(weights.len() - 1);
    let (mut index, mut cumulative) = (0, weights[0]);
    places
        .map(|place| {
            while index < last && place * sum >= cumulative {
                index += 1;
                cumulative += weights[index];
            }
            index
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{super::rng::Purpose, *};

    const ALL: [Resampling; 4] =
        [Resampling::Residual, Resampling::Systematic, Resampling::Stratified, Resampling::Multinomial];

    fn copies(chosen: &[usize], particles: usize) -> Vec<usize> {
        let mut copies = vec![0; particles];
        chosen.iter().for_each(|&index| copies[index] += 1);
        copies
    }

    proptest! {
        #[test]
        fn every_scheme_keeps_the_number_and_only_the_living(
            raw in prop::collection::vec(prop_oneof![Just(0.0), 0.0..1.0_f64], 1..60),
            count in 0_usize..200,
            seed in any::<u64>(),
        ) {
            prop_assume!(raw.iter().sum::<f64>() > 0.0);
            let sum: f64 = raw.iter().sum();
            let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
            for scheme in ALL {
                let chosen = scheme.choose(&weights, count, Stream::new(seed, Purpose::Resample, 0, 0));
                prop_assert_eq!(chosen.len(), count);
                prop_assert!(chosen.iter().all(|&index| weights[index] > 0.0), "{:?} chose a dead particle", scheme);
            }
        }

        #[test]
        fn residual_and_systematic_stay_within_one_copy_of_the_floor(
            raw in prop::collection::vec(0.01..1.0_f64, 1..40),
            seed in any::<u64>(),
        ) {
            let sum: f64 = raw.iter().sum();
            let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
            let stream = Stream::new(seed, Purpose::Resample, 0, 0);
            let expected = |w: f64| 100.0 * w;
            let residual = copies(&Resampling::Residual.choose(&weights, 100, stream), weights.len());
            let systematic = copies(&Resampling::Systematic.choose(&weights, 100, stream), weights.len());
            for ((&w, &r), &s) in weights.iter().zip(&residual).zip(&systematic) {
                prop_assert!(r as f64 >= (expected(w) - 1e-9).floor());
                prop_assert!((s as f64 - expected(w)).abs() <= 1.0 + 1e-9);
            }
        }
    }

    #[test]
    fn every_scheme_is_unbiased() {
        let weights = [0.5, 0.03, 0.27, 0.0, 0.2];
        let (count, runs) = (7, 20_000);
        for scheme in ALL {
            let mut total = [0_usize; 5];
            for seed in 0..runs {
                let chosen = scheme.choose(&weights, count, Stream::new(seed, Purpose::Resample, 0, 0));
                chosen.iter().for_each(|&index| total[index] += 1);
            }
            for (&weight, &copies) in weights.iter().zip(&total) {
                let (mean, expected) = (copies as f64 / runs as f64, count as f64 * weight);
                // A multinomial count has the largest variance: n w (1 − w); five standard errors.
                let tolerance = 5.0 * (count as f64 * weight * (1.0 - weight) / runs as f64).sqrt() + 1e-12;
                assert!(
                    (mean - expected).abs() <= tolerance,
                    "{scheme:?}: {mean} copies, expected {expected}"
                );
            }
        }
    }
}
