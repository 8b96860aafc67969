//! What a report says of effects that were in the model before, and which cells of its maps have a value.

/// What a report says of effects that were in the model before, and which cells of its maps have a value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReportThresholds {
    /// A size differs from the one that was given where it is more than this many standard deviations off, and more than its
    /// material size. Derived: chance in one of 370 sizes that are normally distributed.
    pub(crate) changed_sigmas: f64,
    /// Largest p-value of an effect that the frames show; one that closes a part of the gap is shown, too. Chosen: the
    /// customary level; it says only whether a sentence is told.
    pub(crate) shown_p_value: f64,
    /// Smallest distance of a channel's gap to its noise floor of which it is told how much is closed, as a part of the
    /// floor. Chosen; no measurement.
    pub(crate) least_open_gap: f64,
    /// Smallest part of that distance that is told. Chosen; no measurement.
    pub(crate) least_closed_part: f64,
    /// Part of a parameter's range within which a value is at its end. Chosen: the fits stop at the end itself.
    pub(crate) range_end: f64,
    /// Largest residual that counts as it is where the frame to show is chosen, standard deviations. Chosen; no measurement.
    pub(crate) most_shown_sigmas: f64,
    /// Columns and rows of the map of the picture. Chosen: squares of 20 px at 320 × 240.
    pub(crate) map_picture_grid: [usize; 2],
    /// Side of a cell of the map of the field, metres. Chosen: a cell of the covariance,
    /// [`super::LinearModelThresholds::cluster_cell_m`].
    pub(crate) map_field_cell_m: f64,
    /// Fewest measurements in a cell of a map that has a value. Chosen: the median of five withstands two outliers.
    pub(crate) least_map_measurements: usize,
}

impl ReportThresholds {
    pub(super) const DEFAULT: Self = Self {
        changed_sigmas: 3.0,
        shown_p_value: 0.05,
        least_open_gap: 0.1,
        least_closed_part: 0.1,
        range_end: 0.01,
        most_shown_sigmas: 10.0,
        map_picture_grid: [16, 12],
        map_field_cell_m: 0.5,
        least_map_measurements: 5,
    };
}
