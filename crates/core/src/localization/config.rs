//! Every number of the localizer that can be tuned, with its default and the reason for it.

use crate::filter::PlanarSigma;

/// When a track counts as sure, as likely, or as lost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TrackConfig {
    /// Uncertainty after the odometry was reset, 1.5 m and 1 rad: somebody carried the robot (the kidnapped robot
    /// problem), or the recording has a gap. Wide enough for half of a small field.
    pub kidnapped_sigma: PlanarSigma,
    /// Uncertainty of a settled pose, 2 cm and 0.02 rad: what a sub-pixel fit of lines is worth, with some margin.
    pub settled_sigma: PlanarSigma,
    /// Uncertainty of a pose that fits but is not confirmed yet, 0.3 m and 0.2 rad: it is one place of several.
    pub likely_sigma: PlanarSigma,
    /// Least uncertainty assumed of a filter that may be lost, 0.5 m and 0.4 rad, once for every doubtful picture so far.
    pub lost_sigma: PlanarSigma,
    /// Doubtful pictures that are counted at most, 8: beyond that the prior covers the field anyway.
    pub max_doubtful_frames: u32,
    /// Predictions less certain than this are too wide for the particles, 0.3 m: the field is searched around them.
    pub search_sigma_m: f64,
    /// Predictions less certain than this may have led to the wrong one of two places that fit, 0.15 m: lines of a penalty
    /// area lie about twice as far apart.
    pub long_way_sigma_m: f64,
    /// Odometry that jumps to its origin by more than this was reset, 0.1 m: no robot walks as far between two pictures.
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
