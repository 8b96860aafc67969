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
    /// Times of a jump of the clock that are tried. Chosen for the time that it takes: one in four frames of a minute.
    pub(crate) jump_times: usize,
    pub(crate) input_mistake: InputMistakeThresholds,
}

/// When a recording's files are taken to be meant in another way than they are read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InputMistakeThresholds {
    /// Pictures that are looked at. Chosen for the time that it takes.
    pub(crate) pictures: usize,
    /// Shares of the pieces of line: where less than the first is found as the files stand, another reading has to find the
    /// second. Chosen: wrong poses find less than 0.4 by chance, and the pictures with large effects that they were chosen on
    /// find 0.21 to 0.64 as they stand and no more in any other reading; those with the sides of the field swapped find 0.62,
    /// and 0.95 when these are read as they were meant.
    pub(crate) found_before_and_after: [[f64; 2]; 2],
    /// Pieces of line that a reading has to expect in a picture on average. Chosen; no measurement.
    pub(crate) least_pieces: f64,
    /// Median depression of a camera from which on it can be no number of radians. Chosen: a camera that looks straight down.
    pub(crate) largest_pitch_rad: f64,
    /// Time over which odometry and reference poses are compared, seconds. Chosen: a walking robot's sway, which odometry does
    /// not show, is over in one or two steps.
    pub(crate) odometry_step_s: f64,
    /// Movement in that time that counts at least, metres or radians. Chosen: the errors of both over a step.
    pub(crate) least_movement: f64,
    /// Mean square difference between what the robot states of itself and its reference poses, over the mean square of the
    /// latter, that another reading may leave. Chosen: half of the motion may be odometry's errors.
    pub(crate) most_misfit: f64,
    /// Part of that of the files as they stand which it may leave. Chosen; no measurement.
    pub(crate) least_misfit_ratio: f64,
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
        jump_times: 15,
        input_mistake: InputMistakeThresholds {
            pictures: 8,
            found_before_and_after: [[0.4, 0.6], [0.75, 0.9]],
            least_pieces: 5.0,
            largest_pitch_rad: 1.6,
            odometry_step_s: 1.0,
            least_movement: 0.02,
            most_misfit: 0.5,
            least_misfit_ratio: 0.1,
        },
    };
}
