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
    pub(crate) white_lines: WhiteLineThresholds,
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
    /// Factors by which the focal length of a camera file may be wrong, and their inverses. Chosen: what is nearer to 1 is the
    /// effect `focal_length`.
    pub(crate) camera_factors: [f64; 2],
    /// Step from one such factor to the next. Chosen: half of it moves a line at the edge of the picture by little more than
    /// [`WorkflowThresholds::alignment_near`].
    pub(crate) camera_step: f64,
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

/// When the white lines of the pictures are taken to be those of another field, or there are none. In what follows, "ordinary"
/// are 20 recordings of the repository and of halls, 3 of real cameras, and 58 drawn ones with one effect 30 times as large as
/// its unit; "wrong" are those with a field of 1.5 to 33 times its length, with a camera file that makes no sense, and with black
/// or white pictures.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WhiteLineThresholds {
    /// Pictures that are looked at where no pose was found. Chosen for the time that it takes.
    pub(crate) pictures: usize,
    /// Least part of the pixels that is white where there are lines. Measured: 0 in black and in white pictures, 1.0e-4 to
    /// 3.0e-4 where a blur of 9 px hides the lines, 20e-4 to 400e-4 in others.
    pub(crate) least_white: f64,
    /// Part of the expected pieces of line that chance finds in pictures without white pixels. Chosen; measured: 0.
    pub(crate) found_by_chance: f64,
    /// Part of the pixels from which on white ones are compared with the field. Chosen: between the last two of
    /// [`Self::least_white`].
    pub(crate) least_judged: f64,
    /// Distance of ground that is looked at, in heights of the camera. Chosen: lines farther away are too thin.
    pub(crate) farthest_heights: f64,
    /// Error of the camera's angles that is allowed for, radians, and the largest distance from a line, metres. Chosen: at 0.01
    /// rad and 0.15 m, large effects leave as few white pixels near their lines as a wrong field does; at these they do not.
    pub(crate) tolerance_rad: f64,
    pub(crate) tolerance_m: f64,
    /// Part of the expected pieces that has to be found so that camera and poses are taken to be right. Chosen; measured: 0.76
    /// to 1.0 with a field that is too long.
    pub(crate) aligned: f64,
    /// Pieces of line that have to be expected in a picture on average so that their share tells anything. Chosen as for
    /// [`InputMistakeThresholds::least_pieces`].
    pub(crate) least_pieces: f64,
    /// Least share of the white pixels near the lines of the field, where these are found. Measured: 0.33 to 0.46 with a field
    /// that is too long (0.62 and 0.92 where its goal lines are hardly in view), 0.70 to 1.0 in ordinary recordings, people and
    /// robots in real ones included.
    pub(crate) least_near_aligned: f64,
    /// The same where they are not found. Measured: 0.09 with a camera file that makes no sense, 0.14 to 0.7 with a focal length
    /// that is wrong by a factor, 0.35 to 0.97 with large effects.
    pub(crate) least_near: f64,
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
            camera_factors: [1.25, 2.75],
            camera_step: 1.06,
            largest_pitch_rad: 1.6,
            odometry_step_s: 1.0,
            least_movement: 0.02,
            most_misfit: 0.5,
            least_misfit_ratio: 0.1,
        },
        white_lines: WhiteLineThresholds {
            pictures: 8,
            least_white: 3e-5,
            found_by_chance: 0.05,
            least_judged: 1e-3,
            farthest_heights: 12.0,
            tolerance_rad: 0.06,
            tolerance_m: 0.5,
            aligned: 0.6,
            least_pieces: 5.0,
            least_near_aligned: 0.55,
            least_near: 0.25,
        },
    };
}
