//! All numbers that decide something, each with what it is, its unit, and where it comes from.
//!
//! "Chosen" means that nothing was measured for it. "Set on the study" means that it was chosen with the results of the study
//! in `docs/gap.md` in view, on its draws 0 to 2; the figures of that page are from a draw that no number was set on.

/// Every number that decides something, by the layer that it decides in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Thresholds {
    pub(crate) recording: RecordingThresholds,
    pub(crate) inference: InferenceThresholds,
    pub(crate) workflow: WorkflowThresholds,
}

/// Which frames of a recording are compared, and how many it needs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RecordingThresholds {
    /// Fewest frames that are compared: a quarter of them is held out. Chosen.
    pub(crate) least_frames: usize,
    /// Of more frames than this every second, third … is compared. Chosen for the time that it takes.
    pub(crate) most_frames: usize,
    /// Frames in a row show one view where the camera moved by less than this, metres: several times the usual error of
    /// motion capture. Chosen.
    pub(crate) same_view_m: f64,
    /// And turned by less than this, radians. Chosen.
    pub(crate) same_view_rad: f64,
    /// Fewest views among the fitted frames with which an effect is named or something called unknown. Chosen.
    pub(crate) least_views: usize,
    /// Odometry between frames farther apart than this is not compared, seconds. The same as the longest step that a
    /// trajectory joins by a curve, see [`reality_sim_sensor::Trajectory`].
    pub(crate) longest_step_s: f64,
    /// The camera moves where its distance from the first frame is more than this on average, metres. Chosen.
    pub(crate) moves_m: f64,
    /// Or where it is turned from the first frame by more than this on average, radians. Chosen.
    pub(crate) moves_rad: f64,
}

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
    /// Number of effects beside the best one that are settled in full. Chosen for the time that it takes.
    pub(crate) most_alternatives: usize,
    /// Largest p-value, corrected, of an effect that is tried beside every other one where none is supported alone. Chosen.
    pub(crate) lead_p_value: f64,
    /// Number of effects that are tried so. Chosen for the time that it takes.
    pub(crate) most_leads: usize,

    /// Distance at which lines are looked for from where the first model has them, as a part of the picture's width. Chosen.
    pub(crate) search_first: f64,
    /// The same from where a settled model has them. Chosen.
    pub(crate) search_again: f64,
    /// Steps of Gauss and Newton's method in which a model settles at most. Chosen.
    pub(crate) most_settling_steps: usize,
    /// A model has settled when a step gains less than this, log-likelihood. Chosen.
    pub(crate) settled_gain: f64,
    /// Part of what a model explains by which two settled models may differ, in log-likelihood, and still leave as little as
    /// each other. Set on the study. Not [`Self::model_error`], which is of residuals and decides what is unknown.
    pub(crate) compared_model_error: f64,
    /// Standard deviations at which residuals are cut off where settled models are compared: beyond, they are no measurements.
    /// The same as Tukey's constant in [`crate::linear_model::system`], but as a bound and not as a weight.
    pub(crate) compared_residual_sigmas: f64,
    /// Measurements that the mean residual of a quantity of the pictures stands for where settled models are compared, as
    /// models find different numbers of lines. Chosen.
    pub(crate) picture_rows: f64,
    /// The same of a quantity of the odometry. Chosen.
    pub(crate) odometry_rows: f64,

    /// Part of recordings in which an effect at its detection limit is found. Chosen.
    pub(crate) power: f64,
    /// Part of what a model explains that its residuals may be off by: discs are no Gaussians, clipped colours no gains. Set
    /// on the study. Not [`Self::compared_model_error`], which is of log-likelihoods and decides ties.
    pub(crate) model_error: f64,
    /// Standard deviations beyond which a measurement of a held-out frame is something else than what it should be. As
    /// Tukey's constant in the fits.
    pub(crate) outlying_sigmas: f64,
}

/// How the workflow looks for lines that are not where the model has them, and when it stops.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WorkflowThresholds {
    /// Largest number of effects that are added in one go. Chosen.
    pub(crate) most_effects: usize,
    /// Pictures in which lines are looked for elsewhere. Chosen for the time that it takes.
    pub(crate) alignment_pictures: usize,
    /// A line is found where it is within this part of the picture's width of where the model has it. Chosen.
    pub(crate) alignment_near: f64,
    /// Nothing has to be aligned where this part of all pieces of line is found. Chosen.
    pub(crate) alignment_found: f64,
    /// Pieces of a curve from which on it can be lost. Chosen.
    pub(crate) lost_pieces: f64,
    /// A curve is lost where less than this part of its pieces is found. Chosen.
    pub(crate) lost_found: f64,
    /// Part of what is missing that another alignment has to find. Chosen.
    pub(crate) alignment_gain: f64,
    /// A parameter is tried where a line moves by more than this over its range, pixels. Chosen.
    pub(crate) alignment_least_move_px: f64,
    /// Values of a parameter that are tried, over its range. Chosen for the time that it takes.
    pub(crate) alignment_values: usize,
    /// Parameters that are moved, one after the other. Chosen for the time that it takes.
    pub(crate) alignment_rounds: usize,
}

impl Thresholds {
    /// The values that everything is decided with.
    pub(crate) const DEFAULT: Self = Self {
        recording: RecordingThresholds {
            least_frames: 12,
            most_frames: 240,
            same_view_m: 0.025,
            same_view_rad: 0.02,
            least_views: 8,
            longest_step_s: 0.6,
            moves_m: 0.05,
            moves_rad: 0.05,
        },
        inference: InferenceThresholds {
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
            most_settling_steps: 8,
            settled_gain: 1.0,
            compared_model_error: 0.03,
            compared_residual_sigmas: 5.0,
            picture_rows: 3000.0,
            odometry_rows: 60.0,
            power: 0.9,
            model_error: 0.04,
            outlying_sigmas: 5.0,
        },
        workflow: WorkflowThresholds {
            most_effects: 6,
            alignment_pictures: 10,
            alignment_near: 0.012,
            alignment_found: 0.6,
            lost_pieces: 4.0,
            lost_found: 0.2,
            alignment_gain: 0.4,
            alignment_least_move_px: 2.0,
            alignment_values: 16,
            alignment_rounds: 3,
        },
    };
}
