//! Tunable parameters of refinement and smoothing, each with its default and the reason for it.

use crate::setters::setters;

/// Settings of [`super::Refiner`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RefineConfig {
    /// Distance between samples on the ground, 0.02 m: as dense as the observation model's.
    pub spacing_m: f64,
    /// Minimum distance between samples in the picture, 4 px: denser ones share their errors, see
    /// [`RefineConfig::correlation_px`], and only take time.
    pub spacing_px: f64,
    /// Minimum distance of a sample from any other line, 1.5 line widths: nearer to a corner or crossing, the other line
    /// covers a flank.
    pub min_clearance_line_widths: f64,
    /// Search range of each round, starting from a rough guess, 12 to 4 px: the wider it is, the more often a neighbouring
    /// line is taken for the line, so that it shrinks as the pose gets better. Rounds that a good pose does not need are left
    /// out, see [`RefineConfig::search_per_move`].
    pub wide_search_px: [f64; 5],
    /// Search range of each round, starting from a good guess, 4 px: an error of 1° at a focal length of 230 px.
    pub narrow_search_px: [f64; 5],
    /// Minimum difference between a line and its flanks, 0.3 of the picture's usual difference: lines in shadow pass,
    /// noise and seams of the carpet do not.
    pub min_contrast: f64,
    /// Minimum standard deviation of one offset, 0.08 px: the error that a sharp line drawn without noise still has,
    /// 0.12 px at most in the tests of [`super::measure_offsets`].
    pub offset_sigma_px: f64,
    /// Length of line over which the errors of the offsets are fully correlated, 40 px: lens and calibration err alike
    /// there, so that only one in ten samples counts.
    pub correlation_px: f64,
    /// Number of reweighted least-squares steps on one set of offsets, 4: further ones change the pose by less than its
    /// error.
    pub iterations: u32,
    /// Search range that a round needs, in moves of the lines by the round before it, 2: a step leaves less to move than it
    /// moved (from guesses 2 to 3 px off, in pictures of a ray-traced walk, a thirty-fifth of it at most). Wider rounds are
    /// left out.
    pub search_per_move: f64,
    /// Farthest move of a line by a round of the narrowest range below which the pose is found, 0.04 px: half of the error of
    /// one offset, see [`RefineConfig::offset_sigma_px`].
    pub still_px: f64,
    /// Minimum number of offsets for a fit, 12: twice as many as numbers are fitted.
    pub min_offsets: usize,
    /// Minimum height of a fitted pose, 0.3 of the mount's: a fit that sinks farther has slipped to other lines.
    pub min_height_ratio: f64,
}

setters!(RefineConfig {
    with_spacing_m: spacing_m = f64,
    with_spacing_px: spacing_px = f64,
    with_min_clearance_line_widths: min_clearance_line_widths = f64,
    with_wide_search_px: wide_search_px = [f64; 5],
    with_narrow_search_px: narrow_search_px = [f64; 5],
    with_min_contrast: min_contrast = f64,
    with_offset_sigma_px: offset_sigma_px = f64,
    with_correlation_px: correlation_px = f64,
    with_iterations: iterations = u32,
    with_search_per_move: search_per_move = f64,
    with_still_px: still_px = f64,
    with_min_offsets: min_offsets = usize,
    with_min_height_ratio: min_height_ratio = f64,
});

impl Default for RefineConfig {
    fn default() -> Self {
        Self {
            spacing_m: 0.02,
            spacing_px: 4.0,
            min_clearance_line_widths: 1.5,
            wide_search_px: [12.0, 8.0, 5.0, 4.0, 4.0],
            narrow_search_px: [4.0; 5],
            min_contrast: 0.3,
            offset_sigma_px: 0.08,
            correlation_px: 40.0,
            iterations: 4,
            search_per_move: 2.0,
            still_px: 0.04,
            min_offsets: 12,
            min_height_ratio: 0.3,
        }
    }
}

/// Settings of [`super::smooth_trajectory`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SmoothingConfig {
    /// Number of Gauss–Newton steps of the whole chain, 6: few are enough, since the chain is nearly linear, and each
    /// lets rejected fits come back.
    pub rounds: usize,
    /// Minimum standard deviation of the body's sway between two pictures, forwards and to the left (metres) and in heading
    /// (radians), 3 mm and 3 mrad: no body stands stiller, and the equations stay well conditioned.
    pub min_sway: [f64; 3],
    /// Sway if the pictures cannot determine it, 2 cm and 0.02 rad: the sway of [`crate::filter::MotionNoise`].
    pub default_sway: [f64; 3],
    /// Minimum number of pairs of neighbouring fits that determine the sway, 10: a robust standard deviation
    /// of fewer values errs by more than a third (1.17 / √n of itself).
    pub min_sway_pairs: usize,
    /// Squared Mahalanobis distance from the chain above which a picture's fit is an outlier, made on the wrong line, 40. A
    /// right fit exceeds it once in two million times (χ² of six degrees of freedom); fits of wrong lines are far beyond.
    pub outlier_chi2: f64,
    /// Information of a picture about a direction of its pose above which it can contradict the others there, 1 (a
    /// standard deviation of 1 m or 1 rad): below it, rounding decides where the picture has the pose.
    pub min_information: f64,
}

setters!(SmoothingConfig {
    with_rounds: rounds = usize,
    with_min_sway: min_sway = [f64; 3],
    with_default_sway: default_sway = [f64; 3],
    with_min_sway_pairs: min_sway_pairs = usize,
    with_outlier_chi2: outlier_chi2 = f64,
    with_min_information: min_information = f64,
});

impl Default for SmoothingConfig {
    fn default() -> Self {
        Self {
            rounds: 6,
            min_sway: [0.003; 3],
            default_sway: [0.02; 3],
            min_sway_pairs: 10,
            outlier_chi2: 40.0,
            min_information: 1.0,
        }
    }
}
