//! Resampling: which particles survive, and with how many copies. All schemes are unbiased: a particle's expected number of
//! copies is its weight times the total number of survivors. Douc, Cappé and Moulines, "Comparison of resampling schemes for
//! particle filtering", 2005.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use super::rng::Stream;
use crate::names::{UnknownName, by_name};

/// Resampling scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Resampling {
    /// ⌊n w⌋ copies for certain, the rest drawn from the remainders, as in the paper. Liu and Chen, "Sequential Monte Carlo
    /// methods for dynamic systems", 1998.
    #[default]
    Residual,
    /// One random offset, then equal steps.
    Systematic,
    /// One random position in each of n equal strata.
    Stratified,
    /// n independent draws.
    Multinomial,
}

impl Resampling {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 4] = [Self::Residual, Self::Systematic, Self::Stratified, Self::Multinomial];

    /// Its name in options and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Residual => "residual",
            Self::Systematic => "systematic",
            Self::Stratified => "stratified",
            Self::Multinomial => "multinomial",
        }
    }
}

impl fmt::Display for Resampling {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Resampling {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("resampling scheme", &Self::ALL, Self::name, name)
    }
}

impl Resampling {
    /// Returns the indices of `count` survivors. Each finds its ancestor independently, from prefix sums.
    pub fn resample(self, weights: &[f64], count: usize, stream: Stream) -> Vec<usize> {
        if weights.is_empty() {
            return Vec::new();
        }
        let shares = self.cumulate(weights, count);
        let certain = shares.copies.last().copied().unwrap_or(0);
        let drawn = count - certain;
        // Every draw has a random number of its own, except in systematic resampling, which has only one.
        let place = |draw: usize| match self {
            Self::Systematic => (draw as f64 + stream.uniform(0)) / drawn as f64,
            Self::Stratified => (draw as f64 + stream.uniform(draw as u32)) / drawn as f64,
            Self::Residual | Self::Multinomial => stream.uniform(draw as u32),
        };
        let ancestor = |slot: usize| match slot.checked_sub(certain) {
            None => shares.copies.partition_point(|&copies| copies <= slot),
            Some(draw) => shares.drawn_at(place(draw)),
        };
        (0..count).map(ancestor).collect()
    }

    /// Computes each particle's certain copies and its share of the remaining draws.
    fn cumulate(self, weights: &[f64], count: usize) -> Shares {
        let per_weight = count as f64 / weights.iter().sum::<f64>();
        let (mut copies, mut rests) = (Vec::with_capacity(weights.len()), Vec::with_capacity(weights.len()));
        let (mut copies_so_far, mut rest_so_far) = (0, 0.0);
        for &weight in weights {
            let expected = per_weight * weight;
            let certain = if self == Self::Residual { expected.floor() } else { 0.0 };
            copies_so_far = count.min(copies_so_far + certain as usize);
            rest_so_far += expected - certain;
            copies.push(copies_so_far);
            rests.push(rest_so_far);
        }
        // Rounding may leave the last position beyond the last sum: the last particle with any share takes it.
        let last = rests.partition_point(|&rest| rest < rest_so_far);
        Shares { copies, rests, last }
    }
}

/// Prefix sums over the particles, each including its own share.
struct Shares {
    /// Number of copies for certain.
    copies: Vec<usize>,
    /// Expected number of copies beyond those.
    rests: Vec<f64>,
    /// Last particle whose number is not 0.
    last: usize,
}

impl Shares {
    /// Returns the particle at a position in [0, 1) of the drawn shares.
    fn drawn_at(&self, place: f64) -> usize {
        let all = self.rests.last().copied().unwrap_or(0.0);
        self.rests.partition_point(|&rest| rest <= place * all).min(self.last)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{super::rng::Purpose, *};

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
            for scheme in Resampling::ALL {
                let chosen = scheme.resample(&weights, count, Stream::new(seed, Purpose::Resample, 0, 0));
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
            let residual = copies(&Resampling::Residual.resample(&weights, 100, stream), weights.len());
            let systematic = copies(&Resampling::Systematic.resample(&weights, 100, stream), weights.len());
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
        for scheme in Resampling::ALL {
            let mut total = [0_usize; 5];
            for seed in 0..runs {
                let chosen = scheme.resample(&weights, count, Stream::new(seed, Purpose::Resample, 0, 0));
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
