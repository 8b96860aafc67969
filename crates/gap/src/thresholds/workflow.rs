//! Coarse alignment, and when the workflow stops.

/// How the workflow looks for lines that are not where the model has them, and when it stops.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WorkflowThresholds {
    /// Largest number of effects that are added in one go. Chosen; no measurement.
    pub(crate) most_effects: usize,
    /// Pictures in which lines are looked for elsewhere. Chosen for the time that it takes.
    pub(crate) alignment_pictures: usize,
    /// A line is found where it is within this part of the picture's width of where the model has it. Chosen: a little less
    /// than [`super::InferenceThresholds::search_again`], at which the fits go on.
    pub(crate) alignment_near: f64,
    /// Nothing has to be aligned where this part of all pieces of line is found. Chosen; no measurement.
    pub(crate) alignment_found: f64,
    /// Pieces of a curve from which on it can be lost. Chosen; no measurement.
    pub(crate) lost_pieces: f64,
    /// A curve is lost where less than this part of its pieces is found. Chosen; no measurement.
    pub(crate) lost_found: f64,
    /// Part of what is missing that another alignment has to find. Chosen; no measurement.
    pub(crate) alignment_gain: f64,
    /// A parameter is tried where a line moves by more than this over its range, pixels. Chosen: smaller moves are within
    /// [`Self::alignment_near`] of any picture that is 170 px wide or more.
    pub(crate) alignment_least_move_px: f64,
    /// Values of a parameter that are tried, over its range. Chosen for the time that it takes.
    pub(crate) alignment_values: usize,
    /// Parameters that are moved, one after the other. Chosen for the time that it takes.
    pub(crate) alignment_rounds: usize,
}

impl WorkflowThresholds {
    pub(super) const DEFAULT: Self = Self {
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
    };
}
