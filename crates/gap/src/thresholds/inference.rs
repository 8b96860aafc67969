//! Which effects are supported, and which set of them is selected.

/// Which effects are supported, which set of them is selected, and what can be said of the others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InferenceThresholds {
    /// Frames in a row that are held out together, as neighbours see the same things. Fewer in short recordings. Chosen.
    pub(crate) held_out_run_frames: usize,
    /// One run of so many is held out. Chosen: a quarter of the recording.
    pub(crate) held_out_every: usize,

    /// Folds of the cross-validation. Chosen.
    pub(crate) folds: usize,
    /// Frames in a row that are left out together where an effect changes over time: few, so that it is seen before and
    /// after. Chosen.
    pub(crate) fold_run_frames: usize,
    /// Neighbouring views whose scores are taken to be correlated: the bandwidth of Bartlett's kernel (Newey and West 1987).
    /// Chosen; the test of even p-values in `evidence.rs` measures it on errors that frames share.
    pub(crate) correlated_clusters: usize,
    /// A column has no scatter over the field where its variance by places is below this part of that by views: the odometry.
    /// Chosen.
    pub(crate) least_field_variance_ratio: f64,

    /// Largest p-value of a supported effect, corrected for all effects tested. Chosen, for a rate of wrong names below 2 %
    /// where nothing is missing; the study measures 0 of 220.
    pub(crate) significance: f64,
    /// Smallest gain on held-out frames of a supported effect, log-likelihood: a factor of e⁴ ≈ 55. Chosen.
    pub(crate) least_gain: f64,
    /// Smallest gain on held-out frames of a supported effect, in its standard deviations. Chosen.
    pub(crate) least_gain_score: f64,
    /// Largest p-value of sizes that matter: those above the material size of their parameter. Chosen.
    pub(crate) material_significance: f64,
    /// Sizes of an effect are tested one by one where it has no more than this. Chosen: the knots of the exposure, the effect
    /// of most sizes.
    pub(crate) most_sizes_tested_alone: usize,

    /// Standard deviations of the difference of two gains from which on one set of effects is better than another. Chosen.
    pub(crate) distinguishable_score: f64,
    /// A supported effect may stand for the best one where it gains this part of what that one gains. Set on the study, on
    /// effects so large that the linearised model is far off.
    pub(crate) least_gain_ratio: f64,
    /// Number of effects beside the best one that are fitted until they converge. Chosen for the time that it takes.
    pub(crate) most_alternatives: usize,
    /// Largest p-value, corrected, of an effect that is tried beside every other one where none is supported alone. Chosen.
    pub(crate) lead_p_value: f64,
    /// Number of effects that are tried so. Chosen for the time that it takes.
    pub(crate) most_leads: usize,

    /// Distance at which lines are looked for from where the first model has them, as a part of the picture's width. Chosen.
    pub(crate) search_first: f64,
    /// The same from where a fitted model has them. Chosen.
    pub(crate) search_again: f64,
    /// Largest number of steps of Gauss and Newton's method. Chosen.
    pub(crate) most_gauss_newton_steps: usize,
    /// A fit has converged when a step gains less than this, log-likelihood. Chosen.
    pub(crate) converged_gain: f64,
    /// Part of what a model explains by which two fitted models may differ, in log-likelihood, and still leave as little as
    /// each other. Set on the study. Not [`Self::model_error`], which is of residuals and decides what is unknown.
    pub(crate) compared_model_error: f64,
    /// Standard deviations at which residuals are cut off where fitted models are compared: beyond, they are no measurements.
    /// The same as Tukey's constant in [`crate::linear_model::system`], but as a bound and not as a weight.
    pub(crate) compared_residual_sigmas: f64,
    /// Measurements that the mean residual of a quantity of the pictures stands for where fitted models are compared, as
    /// models find different numbers of lines. Chosen.
    pub(crate) picture_rows: f64,
    /// The same of a quantity of the odometry. Chosen.
    pub(crate) odometry_rows: f64,

    /// A gap has changed where it differs by more than this part of what it was: measuring the lines anew changes it by less.
    /// Chosen.
    pub(crate) least_gap_change: f64,
    /// Part of recordings in which an effect at its detection limit is found. Chosen.
    pub(crate) power: f64,
    /// Part of what a model explains that its residuals may be off by: discs are no Gaussians, clipped colours no gains. Set
    /// on the study. Not [`Self::compared_model_error`], which is of log-likelihoods and decides ties.
    pub(crate) model_error: f64,
    /// Standard deviations beyond which a measurement of a held-out frame is something else than what it should be. As
    /// Tukey's constant in the fits.
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
        compared_residual_sigmas: 5.0,
        picture_rows: 3000.0,
        odometry_rows: 60.0,
        least_gap_change: 0.02,
        power: 0.9,
        model_error: 0.04,
        outlying_sigmas: 5.0,
    };
}
