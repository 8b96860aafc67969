//! Weights of measurements, and how far nominal values and reference poses are trusted.

/// Weights of measurements, and how far nominal values and reference poses are trusted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinearModelThresholds {
    pub(crate) nuisance: NuisanceThresholds,
    pub(crate) pose_error: PoseErrorThresholds,
    pub(crate) reference_drift: ReferenceDriftThresholds,
    /// Rounds of reweighted least squares, each of which finds weights, standard deviations of the residuals and of the
    /// poses' errors in turn. Chosen; no measurement.
    pub(crate) reweighting_rounds: usize,
    /// Cut-off of Tukey's biweight, standard deviations: residuals beyond it have no weight (Huber and Ronchetti 2009,
    /// section 4.8). Chosen: a little above the customary 4.685 of 95 % efficiency; it has 96 %.
    pub(crate) tukey_sigmas: f64,
    /// Information of a picture's measurements, which are correlated, as a part of that of as many independent ones. Chosen;
    /// no measurement.
    pub(crate) independent_share: f64,
    /// Largest part of a column's prior variance that a fit may leave where the recording shows the column at all. Chosen; no
    /// measurement.
    pub(crate) most_prior_share: f64,
    /// Side of the cells of the field that are clusters of the covariance, metres. Chosen: a patch of carpet,
    /// [`NuisanceThresholds::patch_m`].
    pub(crate) cluster_cell_m: f64,
    /// Fewest and most steps of the odometry between a step and those that stand for its movement: they share no pose with
    /// it, and so none of the reference's errors (instrumental variables). Derived: two is the least distance. The most is
    /// chosen. Measured: without them -0.26 ± 0.016 was found for a scale of -0.2, with them -0.491 ± 0.011 for one of -0.48.
    pub(crate) instrument_steps: [usize; 2],
}

/// Standard deviations of the nuisance parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NuisanceThresholds {
    /// Brightness of a line, natural logarithm. Chosen: worn and dusty lines differ by a few percent. Halving it changes a
    /// report, see `docs/figures/gap_thresholds.md`.
    pub(crate) line_level: f64,
    /// Brightness of the carpet, natural logarithm. Chosen: rolls and dirt.
    pub(crate) carpet_level: f64,
    /// Brightness of a patch of carpet against the rest, natural logarithm. Chosen; no measurement.
    pub(crate) patch_level: f64,
    /// Side of such a patch, metres. Chosen; no measurement.
    pub(crate) patch_m: f64,
    /// Sheen of the carpet at grazing incidence, as a part of full scale in linear light. Chosen; no measurement.
    pub(crate) sheen: f64,
    /// Variance of the nominal blur, pixels squared. Chosen: 0.03 px more or less of a blur of 0.5 px.
    pub(crate) blur_px2: f64,
    /// Change of that variance for each factor of e in a line's width, pixels squared. Chosen; no measurement.
    pub(crate) blur_by_width_px2: f64,
    /// Part by which the fitted variance of a disc's or a bar's blur is off. Measured: 10 % on broad lines, up to 28 % on the
    /// thinnest, by the edge and the line spread of a uniform disc, fitted as in [`crate::measurement::line_profile`]. Set on
    /// draw 0: with 8 % a true defocus was outside of its interval.
    pub(crate) blur_shape: f64,
    /// Part by which it is off beyond that on lines thinner than the blur. Measured by the same fits; raised from 15 %
    /// together with [`Self::blur_shape`].
    pub(crate) thin_blur_shape: f64,
    /// Variance of the nominal noise, natural logarithm: the carpet's fine texture looks the same. Chosen; no measurement.
    pub(crate) noise_variance: f64,
}

/// Standard deviations of the reference poses' errors. Pairs are of rotations (radians) and of positions (metres).
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseErrorThresholds {
    /// Those that the first fit assumes. Chosen: several times [`Self::usual`], so that nothing is ruled out.
    pub(crate) initial: [f64; 2],
    /// Those of usual motion capture, the centre of the prior. Derived: the recordings of `crates/hidden` have 2.4 mrad and 3
    /// mm; not measured on a real system.
    pub(crate) usual: [f64; 2],
    /// Weight of the prior, as a part of the weight of a recording. Set on draw 0: without a prior, errors shrank to 0.2 mrad
    /// where lines are few, and brought in false mount_pitch; with it, they are from 2 to 3 mrad.
    pub(crate) prior_weight: f64,
    /// Smallest that are believed. Chosen: a tenth of [`Self::usual`], about.
    pub(crate) least: [f64; 2],
    /// Those of yaw (radians), x and y (metres) where these come from the pictures. Chosen: far larger than the errors of a
    /// filter that has found its place, so that they are as good as free.
    pub(crate) free: [f64; 3],
}

/// Errors of the reference poses that last for seconds or for good.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReferenceDriftThresholds {
    /// Standard deviations of the rotation (radians) and of the position (metres) that the calibration between the markers of
    /// motion capture and the camera is off by. Chosen: what hand-eye calibrations leave, about a millimetre and a twentieth
    /// of a degree; not measured on a real system.
    pub(crate) calibration: [f64; 2],
    /// Largest slow errors that are believed, radians and metres. Chosen: twice [`PoseErrorThresholds::usual`], about; what is
    /// off by more is no motion capture, or lines that were taken for others.
    pub(crate) largest: [f64; 2],
    /// Time constants that are tried, seconds. Chosen: from a few pictures to a recording's length.
    pub(crate) time_constants_s: [f64; 5],
    /// Cosines over the recording. Chosen: with twelve, errors of half a second are seen in a recording of ten seconds; what is
    /// faster is a frame's own error.
    pub(crate) half_periods: usize,
    /// Bins of the variogram. Chosen; no measurement.
    pub(crate) lags: usize,
    /// Longest distance in time of the variogram, as a part of the recording. Chosen: beyond, few pairs are left.
    pub(crate) longest_lag: f64,
    /// Least part of an error that its estimate in a frame is taken to show. Chosen: errors that the pictures hardly tell of
    /// are hardly seen in effects either.
    pub(crate) least_shrinkage: f64,
    /// Slow errors count from this part of a frame's own on. Chosen: smaller ones are lost in the mean of sixty frames.
    pub(crate) least_part: f64,
}

impl LinearModelThresholds {
    pub(super) const DEFAULT: Self = Self {
        nuisance: NuisanceThresholds {
            line_level: 0.02,
            carpet_level: 0.07,
            patch_level: 0.05,
            patch_m: 0.5,
            sheen: 0.01,
            blur_px2: 0.03,
            blur_by_width_px2: 0.02,
            blur_shape: 0.12,
            thin_blur_shape: 0.2,
            noise_variance: 0.2,
        },
        pose_error: PoseErrorThresholds {
            initial: [0.01, 0.02],
            usual: [0.0025, 0.003],
            prior_weight: 0.3,
            least: [2e-4, 5e-4],
            free: [0.1, 0.3, 0.3],
        },
        reference_drift: ReferenceDriftThresholds {
            calibration: [0.001, 0.0015],
            largest: [0.006, 0.006],
            time_constants_s: [0.5, 1.0, 2.0, 4.0, 8.0],
            half_periods: 12,
            lags: 12,
            longest_lag: 0.7,
            least_shrinkage: 0.3,
            least_part: 0.1,
        },
        reweighting_rounds: 4,
        tukey_sigmas: 5.0,
        independent_share: 0.15,
        most_prior_share: 0.1,
        cluster_cell_m: 0.5,
        instrument_steps: [2, 3],
    };
}
