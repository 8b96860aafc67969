//! Tunable parameters of the localizer, each with its default and the reason for it. A reason that names neither a source
//! nor a measurement is an argument: how results change with that value has not been measured.

use crate::{
    filter::{FilterConfig, PlanarSigma},
    goal_colors::GoalColorConfig,
    mount::MountPoseSigma,
    observation::{ObservationConfig, ObservationKind},
    refine::{RefineConfig, SmoothingConfig},
    search::SearchConfig,
    setters::setters,
};

/// Settings of a [`super::Localizer`]. The same defaults serve all cameras and fields.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LocalizerConfig {
    /// Observation model that weighs the particles.
    pub observation: ObservationConfig,
    /// Settings of the particle filter.
    pub filter: FilterConfig,
    /// Whether to use the odometry, true. Without it, each picture is predicted from the previous one alone, as in the
    /// paper.
    pub uses_odometry: bool,
    /// Whether to search the field when the filter is lost, true.
    pub relocalizes: bool,
    /// Whether to fit all six degrees of freedom of each pose with sub-pixel accuracy, true for
    /// [`ObservationKind::Contrast`] only: the paper's models run as in the paper.
    pub refines: bool,
    /// Uncertainty of the mount pose from joints and IMU, for searches, fits and smoothing; the filter has its own, see
    /// [`FilterConfig::mount_sigma`], and [`LocalizerConfig::with_mount_sigma`] sets both.
    pub mount_sigma: MountPoseSigma,
    /// How poses are fitted with sub-pixel accuracy.
    pub refine: RefineConfig,
    /// How all poses of a recording are estimated together.
    pub smoothing: SmoothingConfig,
    /// Uncertainty of a given start pose, 5 cm and 0.05 rad: a robot placed by hand.
    pub start_sigma: PlanarSigma,
    /// Thresholds for a pose to be sure, likely or lost.
    pub track: TrackConfig,
    /// How the results of a search are used.
    pub relocalization: RelocalizationConfig,
    /// How goals of different colours tell the halves of the field apart.
    pub goal_colors: GoalColorConfig,
}

impl LocalizerConfig {
    /// Returns the defaults for an observation model: the paper's two models run as in the paper, `contrast` runs with
    /// all six degrees of freedom and with refinement.
    pub fn new(kind: ObservationKind) -> Self {
        let six = kind == ObservationKind::Contrast;
        let mount_sigma = MountPoseSigma::default();
        Self {
            observation: ObservationConfig::new(kind),
            filter: FilterConfig { mount_sigma: six.then_some(mount_sigma), ..FilterConfig::default() },
            uses_odometry: true,
            relocalizes: true,
            refines: six,
            mount_sigma,
            refine: RefineConfig::default(),
            smoothing: SmoothingConfig::default(),
            start_sigma: PlanarSigma { position_m: 0.05, yaw_rad: 0.05 },
            track: TrackConfig::default(),
            relocalization: RelocalizationConfig::default(),
            goal_colors: GoalColorConfig::default(),
        }
    }

    /// Sets the random seed; the same seed gives the same poses.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.filter.seed = seed;
        self
    }

    /// Sets the uncertainty of the mount pose, also for the filter's particles where they differ in height, pitch and roll.
    pub fn with_mount_sigma(mut self, mount_sigma: MountPoseSigma) -> Self {
        self.mount_sigma = mount_sigma;
        self.filter.mount_sigma = self.filter.mount_sigma.map(|_| mount_sigma);
        self
    }
}

setters!(LocalizerConfig {
    with_observation: observation = ObservationConfig,
    with_filter: filter = FilterConfig,
    with_odometry: uses_odometry = bool,
    with_relocalization: relocalizes = bool,
    with_refinement: refines = bool,
    with_refine_config: refine = RefineConfig,
    with_smoothing_config: smoothing = SmoothingConfig,
    with_start_sigma: start_sigma = PlanarSigma,
    with_track_config: track = TrackConfig,
    with_relocalization_config: relocalization = RelocalizationConfig,
    with_goal_color_config: goal_colors = GoalColorConfig,
});

impl Default for LocalizerConfig {
    fn default() -> Self {
        Self::new(ObservationKind::default())
    }
}

/// How the results of a search are used.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RelocalizationConfig {
    /// Settings of the search itself.
    pub search: SearchConfig,
    /// Spread of the particles around a place that was found, 6 cm and 0.04 rad: small, since the search has refined it
    /// already.
    pub found_sigma: PlanarSigma,
    /// Margin in log-weight by which the best place must beat the second for a search to be clear, 6 (about 400 to 1).
    pub clear_margin: f64,
    /// Margin in log-weight by which a search must beat the filter's own place to move the particles, 4 (about 50 to 1).
    pub move_margin: f64,
    /// Margin in log-weight behind the best place within which other places get particles too, 4 (about 50 to 1).
    pub alternative_margin: f64,
    /// Poses nearer to each other than this are the same place, 0.3 m and 0.2 rad: particles around one find the other.
    pub same_place: PlanarSigma,
}

setters!(RelocalizationConfig {
    with_search: search = SearchConfig,
    with_found_sigma: found_sigma = PlanarSigma,
    with_clear_margin: clear_margin = f64,
    with_move_margin: move_margin = f64,
    with_alternative_margin: alternative_margin = f64,
    with_same_place: same_place = PlanarSigma,
});

impl Default for RelocalizationConfig {
    fn default() -> Self {
        Self {
            search: SearchConfig::default(),
            found_sigma: PlanarSigma { position_m: 0.06, yaw_rad: 0.04 },
            clear_margin: 6.0,
            move_margin: 4.0,
            alternative_margin: 4.0,
            same_place: PlanarSigma { position_m: 0.3, yaw_rad: 0.2 },
        }
    }
}

/// Thresholds for a track to count as sure, likely or lost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TrackConfig {
    /// Uncertainty after an odometry reset, 1.5 m and 1 rad: somebody carried the robot (the kidnapped robot problem),
    /// or the recording has a gap.
    pub kidnapped_sigma: PlanarSigma,
    /// Uncertainty of a settled pose, which the lines determine, 2 cm and 0.02 rad.
    pub settled_sigma: PlanarSigma,
    /// Uncertainty of a pose that fits but is not confirmed yet, 0.3 m and 0.2 rad: it is one of several possible places.
    pub likely_sigma: PlanarSigma,
    /// Minimum uncertainty of a filter that may be lost, 0.5 m and 0.4 rad; multiplied by the number of doubtful
    /// pictures so far.
    pub lost_sigma: PlanarSigma,
    /// Maximum number of doubtful pictures that are counted, 8: by then the prior is 4.5 m wide.
    pub max_doubtful_frames: u32,
    /// Uncertainty of a prediction above which the particles cannot cover it and the field is searched, 0.3 m: a thousand
    /// particles in three dimensions are then 6 cm apart, more than a line's width.
    pub search_sigma_m: f64,
    /// Uncertainty of a prediction above which it may have led to the wrong one of two places that fit, 0.15 m: half of what
    /// triggers a search.
    pub long_way_sigma_m: f64,
    /// Minimum distance of a jump back to the origin for the odometry to count as reset, 0.1 m: a robot that has hardly
    /// left its origin is not taken for one that was carried.
    pub reset_jump_m: f64,
    /// Weight of the newest picture in the slow average of the line fraction, 0.05 (Thrun's α_slow; about 20 pictures).
    pub line_fraction_weight: f64,
    /// Fraction of the slow average below which the filter may be lost, 0.5: an obstacle rarely hides half of the lines.
    pub lost_ratio: f64,
    /// Line fraction below which the filter may be lost whatever the average, 0.15: random poses have about 0.
    pub lost_line_fraction: f64,
    /// Line fraction from which a pose fits, 0.35 (right places in 143 real pictures have 0.41 and more), provided that it also passes [`TrackConfig::fitting_ratio`].
    pub fitting_line_fraction: f64,
    /// Fraction of the slow average from which a pose fits, 0.55: a little above [`TrackConfig::lost_ratio`], so that
    /// no pose both fits and is lost.
    pub fitting_ratio: f64,
    /// Fraction of the white lines in the picture that a pose must explain to fit, 0.4, provided that it also passes
    /// [`TrackConfig::fitting_explained_ratio`]. Robots and people are white, too: right places in 143 real pictures explain 0.49
    /// and more, and the rule was made on these.
    pub fitting_explained_fraction: f64,
    /// Fraction of the slow average of the explained fraction from which a pose fits, 0.6: a robot that comes into view rarely adds
    /// as much white as half of the lines.
    pub fitting_explained_ratio: f64,
    /// Fraction of the slow average of the explained fraction below which the filter may be lost, 0.5: less than what fits.
    pub lost_explained_ratio: f64,
    /// Line fraction from which, with [`TrackConfig::convincing_explained_fraction`], a place needs no search for others, 0.45. Of
    /// the places that a search of the whole field ranked first in 143 real pictures, 113 of 130 right ones pass both, and 2 of 13
    /// wrong ones; the rule was made on these.
    pub convincing_line_fraction: f64,
    /// Explained fraction from which it needs none, 0.85.
    pub convincing_explained_fraction: f64,
    /// Largest distance of a pose from the best fit around it for the pose to be sure, 0.15 m and 0.1 rad: three times
    /// a line's width.
    pub fit_distance: PlanarSigma,
    /// Largest number of other places that are followed, 6: each takes a fit a picture.
    pub most_rivals: usize,
    /// Largest change of a rival's log-odds by one picture, 3: a picture in which something else hides the lines of the right
    /// place must not decide alone.
    pub most_per_picture: f64,
    /// Log-odds against a rival from which it is given up, 6: as [`RelocalizationConfig::clear_margin`].
    pub rival_loses_at: f64,
    /// Log-odds of a rival from which the track goes on at its place, 4: as [`RelocalizationConfig::move_margin`].
    pub rival_wins_at: f64,
    /// Number of consecutive pictures that must fit before one of several places counts as confirmed, 4: by then the robot
    /// has moved on, and at a wrong place its lines have run out.
    pub confirming_frames: u32,
    /// How many of these are granted after a long way without lines, 2, because the track was right before it.
    pub confirmed_on_a_long_way: u32,
    /// Probability of the mirror pose below which a pose can be sure, 0.05: the usual level of significance.
    pub max_mirrored_probability: f64,
    /// Distance between two pictures of a goal from which they are different views of it, 0.5 m: a person's width, so that
    /// who stands before the goal in one view need not stand there in the other.
    pub view_distance_m: f64,
    /// Probability that all pictures of a goal from one place show the colour of the other one, 0.12: by somebody in its
    /// colour, or in another light. A view thus counts 2 at most, as log-odds; one goal needs two for a pose to be sure.
    pub deceiving_view_probability: f64,
    /// Probability that a goal has the colour of the other one from everywhere, 0.02: painted or lit otherwise than the field's
    /// file says. A goal thus counts 3.9 at most, as log-odds, however many pictures show it.
    pub deceiving_landmark_probability: f64,
}

setters!(TrackConfig {
    with_kidnapped_sigma: kidnapped_sigma = PlanarSigma,
    with_settled_sigma: settled_sigma = PlanarSigma,
    with_likely_sigma: likely_sigma = PlanarSigma,
    with_lost_sigma: lost_sigma = PlanarSigma,
    with_max_doubtful_frames: max_doubtful_frames = u32,
    with_search_sigma_m: search_sigma_m = f64,
    with_long_way_sigma_m: long_way_sigma_m = f64,
    with_reset_jump_m: reset_jump_m = f64,
    with_line_fraction_weight: line_fraction_weight = f64,
    with_lost_ratio: lost_ratio = f64,
    with_lost_line_fraction: lost_line_fraction = f64,
    with_fitting_line_fraction: fitting_line_fraction = f64,
    with_fitting_ratio: fitting_ratio = f64,
    with_fitting_explained_fraction: fitting_explained_fraction = f64,
    with_fitting_explained_ratio: fitting_explained_ratio = f64,
    with_lost_explained_ratio: lost_explained_ratio = f64,
    with_convincing_line_fraction: convincing_line_fraction = f64,
    with_convincing_explained_fraction: convincing_explained_fraction = f64,
    with_fit_distance: fit_distance = PlanarSigma,
    with_most_rivals: most_rivals = usize,
    with_most_per_picture: most_per_picture = f64,
    with_rival_loses_at: rival_loses_at = f64,
    with_rival_wins_at: rival_wins_at = f64,
    with_confirming_frames: confirming_frames = u32,
    with_confirmed_on_a_long_way: confirmed_on_a_long_way = u32,
    with_max_mirrored_probability: max_mirrored_probability = f64,
    with_view_distance_m: view_distance_m = f64,
    with_deceiving_view_probability: deceiving_view_probability = f64,
    with_deceiving_landmark_probability: deceiving_landmark_probability = f64,
});

impl Default for TrackConfig {
    fn default() -> Self {
        let sigma = |position_m, yaw_rad| PlanarSigma { position_m, yaw_rad };
        Self {
            kidnapped_sigma: sigma(1.5, 1.0),
            settled_sigma: sigma(0.02, 0.02),
            likely_sigma: sigma(0.3, 0.2),
            lost_sigma: sigma(0.5, 0.4),
            max_doubtful_frames: 8,
            search_sigma_m: 0.3,
            long_way_sigma_m: 0.15,
            reset_jump_m: 0.1,
            line_fraction_weight: 0.05,
            lost_ratio: 0.5,
            lost_line_fraction: 0.15,
            fitting_line_fraction: 0.35,
            fitting_ratio: 0.55,
            fitting_explained_fraction: 0.4,
            fitting_explained_ratio: 0.6,
            lost_explained_ratio: 0.5,
            convincing_line_fraction: 0.45,
            convincing_explained_fraction: 0.85,
            fit_distance: sigma(0.15, 0.1),
            most_rivals: 6,
            most_per_picture: 3.0,
            rival_loses_at: 6.0,
            rival_wins_at: 4.0,
            confirming_frames: 4,
            confirmed_on_a_long_way: 2,
            max_mirrored_probability: 0.05,
            view_distance_m: 0.5,
            deceiving_view_probability: 0.12,
            deceiving_landmark_probability: 0.02,
        }
    }
}
