//! Gains in log-likelihood on held-out frames, and their significance.

use nalgebra::DVector;

use crate::{
    inference::cluster_covariance::{self, LAG},
    linear_model::column::Columns,
    thresholds::Thresholds,
};

const LEAST_SCORE: f64 = Thresholds::DEFAULT.inference.least_gain_score;

/// Gain in log-likelihood on frames that the fit has not seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Gain {
    /// Gain, natural logarithm of the likelihood.
    pub(crate) value: f64,
    /// Standard deviation of the gain.
    pub(crate) sigma: f64,
    /// Score of a rank test that the gain is above zero, in standard deviations.
    rank_score: f64,
    /// Part of the gain by which nuisance parameters and reflectance come nearer to their priors.
    of_priors: f64,
}

/// Gains of a set of effects over the present model, on held-out frames.
#[derive(Debug, Clone)]
pub(crate) struct HeldOutGains {
    /// Gain in log-likelihood of each frame, by a fit to the other parts of the recording.
    frames: Vec<f64>,
    /// Minus the logarithm of the prior density of the fitted nuisance parameters and reflectance. A set that needs nominal
    /// values far from their priors is less plausible, which no frame's gain shows.
    nuisance_penalty: f64,
}

impl HeldOutGains {
    /// Creates the gains of a set. `frames` are the gains frame by frame; `fitted` is the change of all columns in a fit to
    /// all frames.
    pub(crate) fn new(frames: Vec<f64>, fitted: &DVector<f64>, columns: &Columns) -> Self {
        Self { frames, nuisance_penalty: columns.nuisance_energy(fitted.as_slice()) }
    }

    /// Returns the gain of this set over another one.
    pub(crate) fn over(&self, other: &Self) -> Gain {
        let gain = sum_of(&self.differences(other));
        let of_priors = other.nuisance_penalty - self.nuisance_penalty;
        Gain { value: gain.value + of_priors, of_priors, ..gain }
    }

    /// Returns the score of the gain of this set over another one, in standard deviations. It uses the signed roots of the
    /// frames' gains: a gain grows with the square of the effect's size at that time, and roots scatter less.
    pub(crate) fn score_over(&self, other: &Self) -> f64 {
        let roots: Vec<f64> =
            self.differences(other).iter().map(|gain| gain.signum() * gain.abs().sqrt()).collect();
        let sum = sum_of(&roots);
        if sum.sigma > 0.0 { sum.value / sum.sigma } else { 0.0 }
    }

    /// Returns the differences of the frames' gains.
    fn differences(&self, other: &Self) -> Vec<f64> {
        self.frames.iter().zip(&other.frames).map(|(of, over)| of - over).collect()
    }
}

impl Gain {
    /// Returns the part by the priors alone, unless held-out frames are predicted clearly worse. Its standard deviation is that
    /// of half a squared normal variable far from zero.
    pub(crate) fn by_priors(self) -> Self {
        if self.value - self.of_priors < -LEAST_SCORE * self.sigma {
            return self;
        }
        Self { value: self.of_priors, sigma: (2.0 * self.of_priors.max(0.0)).sqrt(), rank_score: 0.0, ..self }
    }

    /// Returns the number of standard deviations by which the gain is above zero. A few frames may contribute most of a
    /// gain, such as those in which the camera turns quickly: then the sum scatters strongly, but its sign does not, and the
    /// rank test is more powerful.
    pub(crate) fn score(self) -> f64 {
        let plain = if self.sigma > 0.0 { self.value / self.sigma } else { 0.0 };
        if self.value > 0.0 { plain.max(self.rank_score) } else { plain }
    }
}

/// Returns the sum over frames with its standard deviation; successive frames are taken to be correlated.
pub(crate) fn sum_of(frames: &[f64]) -> Gain {
    let count = frames.len() as f64;
    let value: f64 = frames.iter().sum();
    let deviations: Vec<DVector<f64>> =
        frames.iter().map(|frame| DVector::from_element(1, frame - value / count)).collect();
    let sigma = cluster_covariance::of_neighbours(&deviations, 1)[(0, 0)].max(0.0).sqrt();
    Gain { value, sigma, rank_score: rank_score(frames), of_priors: 0.0 }
}

/// Score of Wilcoxon's signed-rank test on sums over short runs of successive frames, in standard deviations.
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
        HeldOutGains { frames, nuisance_penalty: 0.0 }
    }

    #[test]
    fn the_score_of_an_effect_that_comes_and_goes_is_higher_by_the_roots_of_its_gains() {
        let wave = held_out((0..40).map(|i| 200.0 * (0.3 * f64::from(i)).sin().powi(2)).collect());
        let nothing = held_out(vec![0.0; 40]);
        let plain = wave.over(&nothing);
        let (score, plain) = (wave.score_over(&nothing), plain.value / plain.sigma);
        assert!(score > 1.2 * plain, "{score} {plain}");
    }

    #[test]
    fn a_gain_by_the_priors_does_not_count_where_frames_are_predicted_worse() {
        let far = HeldOutGains { frames: vec![0.0; 40], nuisance_penalty: 30.0 };
        let gain = |frame: f64| {
            let scattered = |i: u32| frame + f64::from(i % 2) - 0.5;
            held_out((0..40).map(scattered).collect()).over(&far).by_priors()
        };
        assert!(gain(0.0).value == 30.0 && gain(0.0).score() > LEAST_SCORE, "{:?}", gain(0.0));
        assert!(gain(-3.0).value < 0.0, "{:?}", gain(-3.0));
    }

    #[test]
    fn gains_by_chance_are_as_rarely_significant_as_their_p_value_says() {
        let nothing = held_out(vec![0.0; 40]);
        let score = |seed: u64| {
            let mut noise = Noise(seed);
            held_out((0..40).map(|_| 5.0 * noise.next()).collect()).score_over(&nothing)
        };
        let count = (0..400).filter(|&seed| two_sided(score(seed), 15.0) < 0.02).count();
        assert!(count < 24, "{count} of 400");
    }
}
