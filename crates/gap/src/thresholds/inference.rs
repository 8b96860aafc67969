//! Which effects are supported, and which set of them is selected.

use super::LinearModelThresholds;

/// Which effects are supported, which set of them is selected, and what can be said of the others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InferenceThresholds {
    /// Frames in a row that are held out together, as neighbours see the same things. Fewer in short recordings. Chosen; no
    /// measurement.
    pub(crate) held_out_run_frames: usize,
    /// One run of so many is held out. Chosen: a quarter of the recording. Halving it changes a report, see
    /// `docs/figures/gap_thresholds.md`.
    pub(crate) held_out_every: usize,

    /// Folds of the cross-validation. Chosen: between five and ten, as is usual (Hastie, Tibshirani and Friedman 2009,
    /// section 7.10).
    pub(crate) folds: usize,
    /// Frames in a row that are left out together where an effect changes over time: few, so that it is seen before and
    /// after. Chosen; no measurement.
    pub(crate) fold_run_frames: usize,
    /// Neighbouring views whose scores are taken to be correlated: the bandwidth of Bartlett's kernel (Newey and West 1987).
    /// Derived: the rule of thumb 4 (n / 100)^(2/9) (Newey and West 1994) gives 3 for 28 to 99 views. A test in `evidence.rs`
    /// has p-values held to their level with it, on errors that frames share. Doubling it changes a report, see
    /// `docs/figures/gap_thresholds.md`.
    pub(crate) correlated_clusters: usize,
    /// A column has no scatter over the field where its variance by places is below this part of that by views: the odometry.
    /// Chosen: far above rounding, and far below what any measurement with a place has.
    pub(crate) least_field_variance_ratio: f64,

    /// Largest p-value of a supported effect, corrected for all effects tested. Chosen, for a rate of wrong names below 2 %
    /// where nothing is missing; measured on draw 3: 0 of 220.
    pub(crate) significance: f64,
    /// Largest p-value by lines alone and by carpet alone of light that both together show, along what both show. Chosen: a
    /// confirmation, not corrected for all effects; patches of carpet alone pass it once in fifty times.
    pub(crate) surface_significance: f64,
    /// Factor by which the light that lines or carpet show alone may differ from that of both together. Measured on drawn worlds
    /// (development): 0.93 to 1.08 with light hidden, and 0.24, 1.6 and 3.3 in three of 175 with nothing hidden, where reflectances
    /// seemed to agree.
    pub(crate) surface_agreement: f64,
    /// Smallest gain on held-out frames of a supported effect, log-likelihood. Chosen: a likelihood ratio of e⁴ ≈ 55, "strong
    /// evidence" by Kass and Raftery (1995).
    pub(crate) least_gain: f64,
    /// Smallest gain on held-out frames of a supported effect, in its standard deviations. Chosen: chance in one of 160
    /// cases, if gains were normally distributed.
    pub(crate) least_gain_score: f64,
    /// Largest p-value of sizes that matter: those above the material size of their parameter. Set on draw 0: without it, one
    /// of two names given in 220 recordings with nothing hidden came from a size that mattered by chance.
    pub(crate) material_significance: f64,
    /// Sizes of an effect are tested one by one where it has no more than this. Derived: the knots of the exposure, the
    /// effect of most sizes.
    pub(crate) most_sizes_tested_alone: usize,

    /// Standard deviations of the difference of two gains from which on one set of effects is better than another. Chosen: as
    /// [`Self::least_gain_score`].
    pub(crate) distinguishable_score: f64,
    /// A supported effect may stand for the best one where it gains this part of what that one gains: the linearised model is
    /// far off for large effects. Chosen; no measurement.
    pub(crate) least_gain_ratio: f64,
    /// Number of effects beside the best one that are fitted until they converge. Chosen for the time that it takes.
    pub(crate) most_alternatives: usize,
    /// Largest p-value, corrected, of an effect that is tried beside every other one where none is supported alone. Chosen,
    /// when in two recordings of draw 0 with two large effects nothing was named; both are named since.
    pub(crate) lead_p_value: f64,
    /// Number of effects that are tried so. Chosen for the time that it takes.
    pub(crate) most_leads: usize,

    /// Distance at which lines are looked for from where the first model has them, as a part of the picture's width. Chosen:
    /// lines farther off, as of a field that is a third of a metre too large, are left to the coarse alignment.
    pub(crate) search_first: f64,
    /// The same from where a fitted model has them. Chosen: half of [`Self::search_first`].
    pub(crate) search_again: f64,
    /// Largest number of steps of Gauss and Newton's method. Chosen, when parameters came to be held at the ends of their
    /// ranges: six before.
    pub(crate) most_gauss_newton_steps: usize,
    /// A fit has converged when a step gains less than this, log-likelihood. Chosen: a change by 1.4 standard deviations of
    /// one parameter.
    pub(crate) converged_gain: f64,
    /// Part of what a model explains by which two fitted models may differ, in log-likelihood, and still leave as little as
    /// each other. Set on draw 0, where a black level was called a tone curve that left as little. Not [`Self::model_error`],
    /// which is of residuals and decides what is unknown.
    pub(crate) compared_model_error: f64,
    /// Standard deviations at which residuals are cut off where fitted models are compared: beyond, they are no measurements.
    /// Derived: [`super::LinearModelThresholds::tukey_sigmas`], as a bound and not as a weight.
    pub(crate) compared_residual_sigmas: f64,
    /// Measurements that the mean residual of a quantity of the pictures stands for where fitted models are compared, as
    /// models find different numbers of lines. Chosen: 50 in each of 60 frames.
    pub(crate) picture_rows: f64,
    /// The same of a quantity of the odometry. Chosen: one for each of 60 frames.
    pub(crate) odometry_rows: f64,

    /// A gap has changed where it differs by more than this part of what it was. Chosen: measuring the lines anew changes it
    /// by less.
    pub(crate) least_gap_change: f64,
    /// An effect claims the channels that it changes by more than this part of what it changes the first one by, each in its
    /// noise floors. Chosen: what is left of the others is a tenth of the variance.
    pub(crate) claimed_share: f64,
    /// Part of recordings in which an effect at its detection limit is found. Chosen: it defines the limit.
    pub(crate) power: f64,
    /// Recordings that are simulated to see how often an effect of a certain size is found. Derived: a share of 90 % is then known
    /// to 5 %, and the limit, from which the share rises with about its logarithm, to 6 %.
    pub(crate) limit_draws: u64,
    /// Part of what a model explains that its residuals may be off by: discs are no Gaussians, clipped colours no gains. Set
    /// on draw 0. Not [`Self::compared_model_error`], which is of log-likelihoods and decides ties.
    pub(crate) model_error: f64,
    /// Standard deviations beyond which a measurement of a held-out frame is something else than what it should be. Derived:
    /// [`super::LinearModelThresholds::tukey_sigmas`].
    pub(crate) outlying_sigmas: f64,
}

impl InferenceThresholds {
    pub(super) const DEFAULT: Self = Self {
        held_out_run_frames: 5,
        held_out_every: 4,
        folds: 6,
        fold_run_frames: 2,
        correlated_clusters: 3,
        least_field_variance_ratio: 1e-3,
        significance: 0.005,
        surface_significance: 0.02,
        surface_agreement: 1.5,
        least_gain: 4.0,
        least_gain_score: 2.5,
        material_significance: 0.05,
        most_sizes_tested_alone: 12,
        distinguishable_score: 2.5,
        least_gain_ratio: 0.4,
        most_alternatives: 3,
        lead_p_value: 0.05,
        most_leads: 3,
        search_first: 0.028,
        search_again: 0.014,
        most_gauss_newton_steps: 8,
        converged_gain: 1.0,
        compared_model_error: 0.03,
        compared_residual_sigmas: LinearModelThresholds::DEFAULT.tukey_sigmas,
        picture_rows: 3000.0,
        odometry_rows: 60.0,
        least_gap_change: 0.02,
        claimed_share: 0.3,
        power: 0.9,
        limit_draws: 40,
        model_error: 0.04,
        outlying_sigmas: LinearModelThresholds::DEFAULT.tukey_sigmas,
    };
}
