//! Which frames of a recording are compared.

/// Which frames of a recording are compared, and how many it needs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RecordingThresholds {
    /// Fewest frames that are compared. Chosen: of 12 frames nine are fitted, one more than [`Self::least_views`].
    pub(crate) least_frames: usize,
    /// Of more frames than this every second, third … is compared. Chosen for the time that it takes.
    pub(crate) most_frames: usize,
    /// Frames in a row show one view where the camera moved by less than this, metres. Chosen: eight times the usual error of
    /// a reference position, see [`super::PoseErrorThresholds::usual`].
    pub(crate) same_view_m: f64,
    /// And turned by less than this, radians. Chosen: eight times the usual error of a reference rotation.
    pub(crate) same_view_rad: f64,
    /// Fewest views among the fitted frames with which an effect is named or something called unknown. Chosen: eight views,
    /// of which [`super::InferenceThresholds::correlated_clusters`] are correlated, have three degrees of freedom.
    pub(crate) least_views: usize,
    /// Odometry between frames farther apart than this is not compared, seconds. Derived: the longest step that a trajectory
    /// joins by a curve, see [`reality_sim_sensor::Trajectory`].
    pub(crate) longest_step_s: f64,
    /// Reference poses are used up to this time before the first frame and after the last, seconds. Chosen: the largest
    /// delays of the library add up to less.
    pub(crate) trajectory_margin_s: f64,
    /// The camera moves where its distance from the first frame is more than this on average, metres. Chosen: two views.
    pub(crate) moves_m: f64,
    /// Or where it is turned from the first frame by more than this on average, radians. Chosen: two and a half views.
    pub(crate) moves_rad: f64,
}

impl RecordingThresholds {
    pub(super) const DEFAULT: Self = Self {
        least_frames: 12,
        most_frames: 240,
        same_view_m: 0.025,
        same_view_rad: 0.02,
        least_views: 8,
        longest_step_s: 0.6,
        trajectory_margin_s: 0.5,
        moves_m: 0.05,
        moves_rad: 0.05,
    };
}
