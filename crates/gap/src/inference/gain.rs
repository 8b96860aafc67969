//! Gains in log-likelihood on held-out frames, and how surely they are above zero.

use nalgebra::DVector;

use crate::{
    inference::cluster_covariance::{self, LAG},
    linear_model::system::PRIOR,
};

/// A gain in log-likelihood on frames that the fit has not seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Gain {
    pub(crate) value: f64,
    pub(crate) sigma: f64,
    /// How surely it is above zero, in standard deviations of a rank test.
    rank_score: f64,
}

/// Gains of a set of effects over the model as it is, on held-out frames.
#[derive(Debug, Clone)]
pub(crate) struct HeldOutGains {
    /// In log-likelihood, frame by frame, each by a fit to the other parts of the recording.
    frames: Vec<f64>,
    /// Half the sum of squares of the fitted nuisance parameters, in their prior standard deviations: nominal values that
    /// have to be far off speak against the set, and no frame shows it.
    strain: f64,
}

impl HeldOutGains {
    /// `frames` are the gains frame by frame, `fitted` is the change of all columns in a fit to all frames: those of so many
    /// fitted parameters and, behind them, the nuisances'.
    pub(crate) fn new(frames: Vec<f64>, fitted: &DVector<f64>, parameters: usize) -> Self {
        let strain = fitted.iter().skip(parameters).map(|value| value * value).sum::<f64>();
        Self { frames, strain: 0.5 * PRIOR * strain }
    }

    /// By how much this is better than another.
    pub(crate) fn over(&self, other: &Self) -> Gain {
        let gain = sum_of(&self.differences(other));
        Gain { value: gain.value + other.strain - self.strain, ..gain }
    }

    /// How surely this is better than another, in standard deviations. Gains go with the square of what an effect is at
    /// the time: their roots scatter less.
    pub(crate) fn surely_over(&self, other: &Self) -> f64 {
        let roots: Vec<f64> =
            self.differences(other).iter().map(|gain| gain.signum() * gain.abs().sqrt()).collect();
        let sum = sum_of(&roots);
        if sum.sigma > 0.0 { sum.value / sum.sigma } else { 0.0 }
    }

    fn differences(&self, other: &Self) -> Vec<f64> {
        self.frames.iter().zip(&other.frames).map(|(of, over)| of - over).collect()
    }
}

impl Gain {
    /// How many standard deviations above zero. Few frames may have most of a gain, as those in which the camera turns
    /// quickly: their sum scatters much, but its sign does not.
    pub(crate) fn score(self) -> f64 {
        let plain = if self.sigma > 0.0 { self.value / self.sigma } else { 0.0 };
        if self.value > 0.0 { plain.max(self.rank_score) } else { plain }
    }
}

/// Sum over frames with its standard deviation, frames in a row taken to be correlated.
pub(crate) fn sum_of(frames: &[f64]) -> Gain {
    let count = frames.len() as f64;
    let value: f64 = frames.iter().sum();
    let left: Vec<DVector<f64>> =
        frames.iter().map(|frame| DVector::from_element(1, frame - value / count)).collect();
    let sigma = cluster_covariance::of_neighbours(&left, 1)[(0, 0)].max(0.0).sqrt();
    Gain { value, sigma, rank_score: rank_score(frames) }
}

/// Wilcoxon's signed-rank test on sums over a few frames in a row each: how many standard deviations above even.
fn rank_score(frames: &[f64]) -> f64 {
    let mut sums: Vec<f64> = frames.chunks(LAG).map(|run| run.iter().sum()).collect();
    sums.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let count = sums.len() as f64;
    let positive: f64 =
        (1..).zip(&sums).filter(|(_, sum)| **sum > 0.0).map(|(rank, _)| f64::from(rank)).sum();
    let even = count * (count + 1.0) / 4.0;
    let sigma = (count * (count + 1.0) * (2.0 * count + 1.0) / 24.0).sqrt();
    (positive - even) / sigma.max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{inference::hypothesis_test::two_sided, testing::Noise};

    fn held_out(frames: Vec<f64>) -> HeldOutGains {
        HeldOutGains { frames, strain: 0.0 }
    }

    #[test]
    fn gains_of_what_comes_and_goes_are_surer_by_their_roots() {
        let wave = held_out((0..40).map(|i| 200.0 * (0.3 * f64::from(i)).sin().powi(2)).collect());
        let nothing = held_out(vec![0.0; 40]);
        let plain = wave.over(&nothing);
        let (surely, plain) = (wave.surely_over(&nothing), plain.value / plain.sigma);
        assert!(surely > 1.2 * plain, "{surely} {plain}");
    }

    #[test]
    fn gains_by_chance_are_sure_as_seldom_as_they_should_be() {
        let nothing = held_out(vec![0.0; 40]);
        let sure = |seed: u64| {
            let mut noise = Noise(seed);
            held_out((0..40).map(|_| 5.0 * noise.next()).collect()).surely_over(&nothing)
        };
        let count = (0..400).filter(|&seed| two_sided(sure(seed), 15.0) < 0.02).count();
        assert!(count < 24, "{count} of 400");
    }
}
