//! Fits, tests and comparisons of sets of effects, from the sums of [`crate::linear_model::system`].

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

use crate::{
    inference::split::stretch,
    linear_model::column::ColumnIndex,
    linear_model::normal_equations::NormalEquations,
    linear_model::reduced_equations::{Fit, ReducedEquations, UNSEEN},
    linear_model::system::{LinearSystem, PRIOR},
};

/// Frames one after the other see the same things: scores are taken to be correlated over this many (Newey and West,
/// 1987).
const LAG: usize = 3;
/// Parts of the recording that are left out in turn.
const FOLDS: usize = 6;
/// Frames in a row that are left out together where an effect changes over time: few, so that it is seen before and
/// after. Else a fold is one stretch.
const RUN: usize = 2;

/// A gain in log-likelihood on frames that the fit has not seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Gain {
    pub(crate) value: f64,
    pub(crate) sigma: f64,
    /// How surely it is above zero, in standard deviations of a rank test.
    rank_score: f64,
}

/// What a set of effects gains over the model as it is.
#[derive(Debug, Clone)]
pub(crate) struct HeldOut {
    /// In log-likelihood, frame by frame, each judged by a fit to the other parts of the recording.
    frames: Vec<f64>,
    /// Half the sum of squares of what tolerances have to be, in their standard deviations: nominal values that are
    /// this far off speak against the set. No frame tells.
    strain: f64,
}

impl HeldOut {
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

/// How unlikely it is that a number of this many standard deviations, found from scatter with these degrees of freedom,
/// is as far from zero by chance.
pub(crate) fn two_sided(score: f64, degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.max(1.0)).map_or(1.0, |student| 2.0 * student.sf(score.abs()))
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

/// A system seen from where the model is.
#[derive(Debug)]
pub(crate) struct Evidence<'a> {
    system: &'a LinearSystem,
    /// The effects' coordinates.
    pub(crate) base: DVector<f64>,
    total: ReducedEquations,
    stretches: Vec<Fold>,
    runs: Vec<Fold>,
}

/// The frames that are left out, and the sums over all others.
type Fold = (Vec<usize>, ReducedEquations);

impl<'a> Evidence<'a> {
    /// `base` is where the model is, in the coordinates of the effects' columns; the tolerances' are behind them.
    pub(crate) fn new(system: &'a LinearSystem, base: DVector<f64>) -> Self {
        let size = system.size;
        let count = system.frames.len();
        let folds = FOLDS.min(count).max(1);
        let fold = |is_left_out: &dyn Fn(usize) -> bool| -> Fold {
            let (left_out, others): (Vec<usize>, Vec<usize>) =
                (0..count).partition(|frame| is_left_out(*frame));
            let total =
                ReducedEquations::of(others.iter().map(|&frame| &system.frames[frame]), size, base.len());
            (left_out, total)
        };
        let total = ReducedEquations::of(system.frames.iter(), size, base.len());
        let stretches =
            (0..folds).map(|index| fold(&|frame| stretch(frame, count, folds) == index)).collect();
        let runs = (0..folds).map(|index| fold(&|frame| frame / RUN % folds == index)).collect();
        Self { system, base, total, stretches, runs }
    }

    /// Number of different views.
    pub(crate) fn views(&self) -> usize {
        self.system.views.len()
    }

    /// Degrees of freedom of the scatter from view to view: fewer than views, as neighbouring ones are taken together
    /// (Kiefer and Vogelsang 2005: of Bartlett's kernel, about one and a half times views by its width).
    pub(crate) fn degrees(&self) -> usize {
        3 * self.views() / (2 * (LAG + 1))
    }

    pub(crate) fn fit(&self, free: &[ColumnIndex]) -> Option<Fit> {
        self.total.fit(free, &self.base)
    }

    /// The others changed by what is held.
    pub(crate) fn fit_beside(&self, free: &[ColumnIndex], held: &DVector<f64>) -> Option<Fit> {
        self.total.fit_beside(free, &self.base, held)
    }

    /// The model as it is: nothing moves but the tolerances.
    pub(crate) fn as_it_is(&self) -> Option<Fit> {
        // From a base of zero, effects that are not free stay where they are.
        self.total.fit(&[], &DVector::zeros(self.base.len()))
    }

    /// What moving the model to a fit gains on the frames that were fitted, whatever the tolerances are.
    pub(crate) fn improvement(&self, fit: &Fit) -> f64 {
        self.total.gain(&fit.delta)
    }

    /// What a set of free columns gains over the model as it is; in short runs where an effect changes over time. `shared`
    /// columns are free in what this is compared with as well: where the other frames do not tell of them, they stay where
    /// the model is, or a line that is seen in the frames left out alone would drown what the sets differ in.
    pub(crate) fn held_out(
        &self,
        free: &[ColumnIndex],
        shared: &[ColumnIndex],
        over_time: bool,
    ) -> Option<HeldOut> {
        let mut frames = vec![0.0; self.system.frames.len()];
        let mut drawn_to = self.base.clone();
        for &column in shared {
            drawn_to[column.0] = 0.0;
        }
        for (left_out, others) in if over_time { &self.runs } else { &self.stretches } {
            let delta = others.fit_beside(free, &drawn_to, &-&self.base)?.delta;
            for &frame in left_out {
                frames[frame] = self.system.frames[frame].gain(&delta);
            }
        }
        let delta = self.fit(free)?.delta;
        let strain = delta.iter().skip(self.base.len()).map(|value| value * value).sum::<f64>();
        Some(HeldOut { frames, strain: 0.5 * PRIOR * strain })
    }

    /// Covariance of the free columns by the scatter from frame to frame, and by that from place to place on the field
    /// (sandwich estimators).
    pub(crate) fn covariances(&self, fit: &Fit) -> [DMatrix<f64>; 2] {
        let scores = |sums: &'a [NormalEquations]| -> Vec<DVector<f64>> {
            let score = |sums: &NormalEquations| self.total.projected(&sums.score(&fit.delta), &fit.free);
            sums.iter().map(score).collect()
        };
        let tolerances = self.total.tolerance_scatter(&fit.free);
        let sandwich = |meat: DMatrix<f64>| &fit.inverse * (meat + &tolerances) * &fit.inverse;
        let size = fit.free.len();
        [
            sandwich(correlated(&scores(&self.system.views), size)),
            sandwich(independent(&scores(&self.system.cells), size)),
        ]
    }

    /// How surely the columns `tested`, a part of the free ones, are not where the effect vanishes: the weaker of both
    /// covariances' evidence (Hotelling's T²).
    pub(crate) fn p_value(&self, fit: &Fit, tested: &[ColumnIndex]) -> f64 {
        // Of what cannot be seen there is no scatter either.
        let tested: Vec<ColumnIndex> =
            tested.iter().copied().filter(|&column| fit.prior_share(column) < UNSEEN).collect();
        let tested = tested.as_slice();
        if tested.is_empty() {
            return 1.0;
        }
        let counts = [self.degrees() + 1, self.system.cells.len()];
        let covariances = self.covariances(fit);
        let place = |column: &ColumnIndex| fit.place(*column);
        // What is not seen on the field has no scatter there: the odometry.
        let seen = |covariance: &DMatrix<f64>| {
            let on_field =
                tested.iter().filter_map(place).map(|i| covariance[(i, i)] / covariances[0][(i, i)]);
            on_field.fold(0.0, f64::max) > 1e-3
        };
        let with_counts = covariances.iter().zip(counts).filter(|(covariance, _)| seen(covariance));
        with_counts.map(|(covariance, count)| self.p_of(fit, tested, covariance, count)).fold(0.0, f64::max)
    }

    fn p_of(&self, fit: &Fit, tested: &[ColumnIndex], covariance: &DMatrix<f64>, count: usize) -> f64 {
        let places: Vec<usize> = tested.iter().filter_map(|&column| fit.place(column)).collect();
        let number = places.len();
        if number == 0 || count <= number + 1 {
            return 1.0;
        }
        let part = DMatrix::from_fn(number, number, |i, j| covariance[(places[i], places[j])]);
        let value = DVector::from_fn(number, |i, _| self.base[tested[i].0] + fit.delta[tested[i].0]);
        let Some(squared) = squared_distance(&part, &value) else { return 1.0 };
        let degrees = (count - number) as f64;
        let statistic = squared * degrees / (number as f64 * (count - 1) as f64);
        match FisherSnedecor::new(number as f64, degrees) {
            Ok(distribution) if statistic.is_finite() && statistic > 0.0 => distribution.sf(statistic),
            _ => 1.0,
        }
    }

    /// Standard deviation of a free column. What is held by its prior alone scatters little from frame to frame, and is as
    /// unknown as before.
    pub(crate) fn sigma(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        let Some(place) = fit.place(column) else { return 0.0 };
        let variances = self.covariances(fit).map(|covariance| covariance[(place, place)]);
        let of_prior = PRIOR * fit.inverse.column(place).norm_squared();
        (variances.into_iter().fold(0.0, f64::max) + of_prior).sqrt()
    }

    /// Correlation of the errors of two free columns: of their scatter from frame to frame, and of what is not known of them.
    pub(crate) fn correlation(&self, fit: &Fit, columns: [ColumnIndex; 2]) -> f64 {
        let [Some(i), Some(j)] = columns.map(|column| fit.place(column)) else { return 0.0 };
        let [scatter, _] = self.covariances(fit);
        let covariance = scatter + &fit.inverse * &fit.inverse * PRIOR;
        let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if scale > 0.0 { (covariance[(i, j)] / scale).clamp(-1.0, 1.0) } else { 0.0 }
    }
}

/// `vᵀ C⁻¹ v`. Parameters that hardly differ in what they do leave the covariance all but singular.
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

/// Sum over frames with its standard deviation, frames in a row taken to be correlated.
pub(crate) fn sum_of(frames: &[f64]) -> Gain {
    let count = frames.len() as f64;
    let value: f64 = frames.iter().sum();
    let left: Vec<DVector<f64>> =
        frames.iter().map(|frame| DVector::from_element(1, frame - value / count)).collect();
    let sigma = correlated(&left, 1)[(0, 0)].max(0.0).sqrt();
    Gain { value, sigma, rank_score: rank_score(frames) }
}

/// Quantile of Student's distribution.
pub(crate) fn student_quantile(probability: f64, degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees.max(1.0))
        .map_or(f64::INFINITY, |student| student.inverse_cdf(probability))
}

/// Sum of squares of scores with Bartlett's weights for those of neighbouring frames.
fn correlated(scores: &[DVector<f64>], size: usize) -> DMatrix<f64> {
    let mut meat = DMatrix::zeros(size, size);
    for (index, score) in scores.iter().enumerate() {
        meat.ger(1.0, score, score, 1.0);
        for lag in 1..=LAG.min(index) {
            let weight = 1.0 - lag as f64 / (LAG + 1) as f64;
            meat.ger(weight, score, &scores[index - lag], 1.0);
            meat.ger(weight, &scores[index - lag], score, 1.0);
        }
    }
    let count = scores.len() as f64;
    meat * (count / (count - 1.0).max(1.0))
}

fn independent(scores: &[DVector<f64>], size: usize) -> DMatrix<f64> {
    let mut meat = DMatrix::zeros(size, size);
    for score in scores {
        meat.ger(1.0, score, score, 1.0);
    }
    let count = scores.len() as f64;
    meat * (count / (count - 1.0).max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Noise, system_of};

    const BOTH: [ColumnIndex; 2] = [ColumnIndex(0), ColumnIndex(1)];

    type Equations = (DMatrix<f64>, DVector<f64>);

    /// Frames with 20 rows each of two columns; all rows of a frame share an error of their own besides.
    fn frames(seed: u64, truth: [f64; 2], shared: f64) -> Vec<Equations> {
        let mut noise = Noise(seed);
        let mut frame = || {
            let common = shared * noise.next();
            let (mut a, mut g) = (DMatrix::zeros(2, 2), DVector::zeros(2));
            for _ in 0..20 {
                let row = DVector::from_vec(vec![1.0 + 0.3 * noise.next(), noise.next()]);
                let residual = row.dot(&DVector::from_vec(truth.to_vec())) + common + noise.next();
                a.ger(1.0, &row, &row, 1.0);
                g += residual * row;
            }
            (a, g)
        };
        (0..45).map(|_| frame()).collect()
    }

    fn system(seed: u64, truth: [f64; 2], shared: f64) -> LinearSystem {
        system_of(frames(seed, truth, shared))
    }

    #[test]
    fn without_an_effect_p_values_are_even_although_rows_of_a_frame_share_errors() {
        let p_values: Vec<f64> = (0..400)
            .map(|seed| {
                let system = system(seed, [0.0, 0.0], 1.0);
                let evidence = Evidence::new(&system, DVector::zeros(2));
                evidence.p_value(&evidence.fit(&BOTH).unwrap(), &BOTH[..1])
            })
            .collect();
        let below = |p: f64| p_values.iter().filter(|value| **value < p).count() as f64 / 400.0;
        // Rows taken as independent would make about 60 % of them significant at 5 %.
        assert!(below(0.05) < 0.12, "{}", below(0.05));
        assert!(below(0.005) < 0.03, "{}", below(0.005));
        assert!((below(0.5) - 0.5).abs() < 0.12, "{}", below(0.5));
    }

    fn held_out(frames: Vec<f64>) -> HeldOut {
        HeldOut { frames, strain: 0.0 }
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

    #[test]
    fn an_effect_is_found_with_its_size_and_gains_on_unseen_frames() {
        let mut inside = 0;
        for seed in 0..200 {
            let system = system(seed, [0.6, -0.2], 0.5);
            let evidence = Evidence::new(&system, DVector::zeros(2));
            let fit = evidence.fit(&BOTH).unwrap();
            assert!(evidence.p_value(&fit, &BOTH[..1]) < 1e-3);
            let nothing = evidence.held_out(&[], &[], false).unwrap();
            let gain = evidence.held_out(&BOTH, &[], false).unwrap().over(&nothing);
            assert!(gain.value > 0.0 && gain.score() > 2.0);
            let sigma = evidence.sigma(&fit, BOTH[0]);
            inside += usize::from((fit.delta[0] - 0.6).abs() < 1.96 * sigma);
        }
        assert!((170..=199).contains(&inside), "{inside} of 200");
    }

    #[test]
    fn what_hardly_shows_is_as_unknown_as_before() {
        let mut frames = frames(1, [0.5, 0.0], 0.5);
        // The second column changes next to nothing.
        for (a, g) in &mut frames {
            a.row_mut(1).scale_mut(1e-3);
            a.column_mut(1).scale_mut(1e-3);
            g[1] *= 1e-3;
        }
        let system = system_of(frames);
        let evidence = Evidence::new(&system, DVector::zeros(2));
        let fit = evidence.fit(&BOTH).unwrap();
        assert!(evidence.sigma(&fit, BOTH[1]) > 0.99 && evidence.sigma(&fit, BOTH[0]) < 0.1);
    }

    #[test]
    fn what_is_not_there_gains_nothing_on_unseen_frames() {
        let gains: Vec<f64> = (0..100)
            .map(|seed| {
                let system = system(seed, [0.5, 0.0], 0.5);
                let evidence = Evidence::new(&system, DVector::zeros(2));
                evidence
                    .held_out(&BOTH, &[], false)
                    .unwrap()
                    .over(&evidence.held_out(&BOTH[..1], &[], false).unwrap())
                    .value
            })
            .collect();
        assert!(gains.iter().sum::<f64>() < 0.0);
    }

    #[test]
    fn an_effect_held_at_neutral_is_taken_out_of_the_model() {
        let mut frames = frames(3, [0.4, 0.0], 0.0);
        // The model has the effect already: nothing is left of it.
        let base = DVector::from_vec(vec![0.4, 0.0]);
        for (a, g) in &mut frames {
            *g -= &*a * &base;
        }
        let system = system_of(frames);
        let evidence = Evidence::new(&system, base);
        let kept = evidence.held_out(&BOTH, &[], false).unwrap();
        assert!(
            evidence.held_out(&BOTH[1..], &[], false).unwrap().over(&kept).value < -50.0,
            "without it much is lost"
        );
        let kept = evidence.fit(&BOTH).unwrap();
        assert!(kept.delta[0].abs() < 0.1);
    }
}
