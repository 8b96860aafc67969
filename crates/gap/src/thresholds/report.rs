//! What a report says of effects that were in the model before, and which cells of its maps have a value.

/// What a report says of effects that were in the model before, and which cells of its maps have a value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReportThresholds {
    /// A size differs from the one that was given where it is more than this many standard deviations off, and more than its
    /// material size. Chosen.
    pub(crate) changed_sigmas: f64,
    /// Largest p-value of an effect that the frames show; one that closes a part of the gap is shown, too. Chosen.
    pub(crate) shown_p_value: f64,
    /// Fewest measurements in a cell of a map that has a value. Chosen.
    pub(crate) least_map_measurements: f64,
}

impl ReportThresholds {
    pub(super) const DEFAULT: Self =
        Self { changed_sigmas: 3.0, shown_p_value: 0.05, least_map_measurements: 5.0 };
}
