//! Every number of the localizer that can be tuned, with its default and the reason for it.

use crate::{
    filter::{FilterConfig, PlanarSigma},
    goal_colors::GoalColorConfig,
    mount::MountPoseSigma,
    observation::{ObservationConfig, ObservationKind},
    search::SearchConfig,
};

/// Settings of a [`super::Localizer`]. The defaults are one set for all cameras and fields.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LocalizerConfig {
    /// The observation model that weighs the particles.
    pub observation: ObservationConfig,
    /// The particle filter.
    pub filter: FilterConfig,
    /// Use the odometry; without it the previous picture alone predicts the next, as in the paper.
    pub uses_odometry: bool,
    /// Search the field when the filter is lost.
    pub relocalizes: bool,
    /// Fit each pose to a fraction of a pixel, height, pitch and roll included.
    pub refines: bool,
    /// What joints and IMU are worth.
    pub mount_sigma: MountPoseSigma,
    /// Uncertainty of a start pose that was given, 5 cm and 0.05 rad: a robot placed by hand.
    pub start_sigma: PlanarSigma,
    /// When a pose is sure, likely or lost.
    pub track: TrackConfig,
    /// What becomes of the places that a search finds.
    pub relocalization: RelocalizationConfig,
    /// How goals of different colours tell the halves of the field apart.
    pub goal_colors: GoalColorConfig,
}

impl LocalizerConfig {
    /// The defaults for an observation model: the paper's two as in the paper, `contrast` with all six degrees of freedom
    /// and refinement.
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
            start_sigma: PlanarSigma { position_m: 0.05, yaw_rad: 0.05 },
            track: TrackConfig::default(),
            relocalization: RelocalizationConfig::default(),
            goal_colors: GoalColorConfig::default(),
        }
    }

    /// With another observation model or other settings of it.
    pub fn with_observation(self, observation: ObservationConfig) -> Self {
        Self { observation, ..self }
    }

    /// With other settings of the particle filter.
    pub fn with_filter(self, filter: FilterConfig) -> Self {
        Self { filter, ..self }
    }

    /// With another seed: the same seed gives the same poses.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.filter.seed = seed;
        self
    }

    /// With or without odometry.
    pub fn with_odometry(self, uses_odometry: bool) -> Self {
        Self { uses_odometry, ..self }
    }

    /// With or without searching for a lost pose.
    pub fn with_relocalization(self, relocalizes: bool) -> Self {
        Self { relocalizes, ..self }
    }

    /// With or without the sub-pixel fit.
    pub fn with_refinement(self, refines: bool) -> Self {
        Self { refines, ..self }
    }
}

impl Default for LocalizerConfig {
    fn default() -> Self {
        Self::new(ObservationKind::default())
    }
}

/// What becomes of the places that a search finds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RelocalizationConfig {
    /// The search itself.
    pub search: SearchConfig,
    /// Spread of the particles around a place that was found, 6 cm and 0.04 rad: the search has refined it already.
    pub found_sigma: PlanarSigma,
    /// A search has one answer only where the next place is at least this much worse in log-weight, 6 (about 400 to 1).
    pub clear_margin: f64,
    /// A search must beat the filter's own place by this much in log-weight to move the particles, 4 (about 50 to 1).
    pub move_margin: f64,
    /// Places worse than the best one by more than this in log-weight get no particles, 4 (about 50 to 1).
    pub alternative_margin: f64,
    /// Poses nearer than this are of one place, 0.3 m and 0.2 rad: particles around the one find the other.
    pub same_place: PlanarSigma,
}

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

/// When a track counts as sure, as likely, or as lost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TrackConfig {
    /// Uncertainty after the odometry was reset, 1.5 m and 1 rad: somebody carried the robot (the kidnapped robot
    /// problem), or the recording has a gap.
    pub kidnapped_sigma: PlanarSigma,
    /// Uncertainty of a settled pose by the lines, 2 cm and 0.02 rad.
    pub settled_sigma: PlanarSigma,
    /// Uncertainty of a pose that fits but is not confirmed yet, 0.3 m and 0.2 rad: it is one place of several.
    pub likely_sigma: PlanarSigma,
    /// Least uncertainty assumed of a filter that may be lost, 0.5 m and 0.4 rad, once for every doubtful picture so far.
    pub lost_sigma: PlanarSigma,
    /// Doubtful pictures that are counted at most, 8: by then the prior is 4.5 m wide.
    pub max_doubtful_frames: u32,
    /// Predictions less certain than this are too wide for the particles, 0.3 m: the field is searched around them.
    pub search_sigma_m: f64,
    /// Predictions less certain than this may have led to the wrong one of two places that fit, 0.15 m: half
    /// of what asks for a search.
    pub long_way_sigma_m: f64,
    /// Odometry that jumps to its origin by more than this was reset, 0.1 m: a robot that has
    /// hardly left its origin is not taken for one that was carried.
    pub reset_jump_m: f64,
    /// Weight of the newest picture in the slow average of the line fraction, 0.05 (Thrun's α_slow; about 20 pictures).
    pub line_fraction_weight: f64,
    /// Below this fraction of the slow average the filter may be lost, 0.5.
    pub lost_ratio: f64,
    /// Below this line fraction the filter may be lost whatever the average, 0.15: poses chosen at random have about 0.
    pub lost_line_fraction: f64,
    /// From this line fraction on a pose fits, 0.25, where [`TrackConfig::fitting_ratio`] holds as well.
    pub fitting_line_fraction: f64,
    /// From this fraction of the slow average on a pose fits, 0.55: a little above [`TrackConfig::lost_ratio`], so that
    /// no pose is both.
    pub fitting_ratio: f64,
    /// Pictures in a row that must fit before one of several places counts as confirmed, 4.
    pub confirming_frames: u32,
    /// Of these, pictures that need not be waited for after a long way without lines, 2: the track was right before it.
    pub confirmed_on_a_long_way: u32,
    /// A pose is sure while its mirror image on the field is less probable than this, 0.05.
    pub max_mirrored_probability: f64,
}

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
            fitting_line_fraction: 0.25,
            fitting_ratio: 0.55,
            confirming_frames: 4,
            confirmed_on_a_long_way: 2,
            max_mirrored_probability: 0.05,
        }
    }
}
