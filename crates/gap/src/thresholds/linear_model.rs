//! Weights of measurements, and how far nominal values and reference poses are trusted.

/// Weights of measurements, and how far nominal values and reference poses are trusted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinearModelThresholds {
    pub(crate) nuisance: NuisanceThresholds,
    pub(crate) reflectance: ReflectanceThresholds,
    pub(crate) pose_error: PoseErrorThresholds,
    pub(crate) reference_drift: ReferenceDriftThresholds,
    /// Distance up to which carpet tells of the light on it, metres. Chosen: farther off, a block covers more than the light
    /// is alike on, and what stands behind it shines through the blur.
    pub(crate) light_range_m: f64,
    /// Part of all views of places beyond each edge of the rectangle in which the light was measured. Chosen: a few views of
    /// a far end must not stretch it.
    pub(crate) light_seen_share: f64,
    /// Longest time between a picture and its reference pose at which both show the same moment of a step, seconds. Chosen: a
    /// hundredth of a step.
    pub(crate) same_step_s: f64,
    /// Rounds of reweighted least squares, each of which finds weights, standard deviations of the residuals and of the
    /// poses' errors in turn: so many before slow errors of the poses are known, and so many after. Chosen; no measurement.
    pub(crate) reweighting_rounds: usize,
    /// Rounds in which the pose of a held-out frame is refitted. Measured with errors of 3 mrad and 3 mm in poses of 320×240
    /// pictures (seed 204 of `tests/gap/reference.rs`): the third round still changes the gap by 1 %, the fourth by no digit.
    pub(crate) refitting_rounds: usize,
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
    /// twice the smallest patch of carpet.
    pub(crate) cluster_cell_m: f64,
    /// Fewest and most steps of the odometry between a step and those that stand for its movement: they share no pose with
    /// it, and so none of the reference's errors (instrumental variables). Derived: two is the least distance. The most is
    /// chosen. Measured: without them -0.26 ± 0.016 was found for a scale of -0.2, with them -0.491 ± 0.011 for one of -0.48.
    pub(crate) instrument_steps: [usize; 2],
}

/// Standard deviations of the nuisance parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NuisanceThresholds {
    /// Nominal brightness of lines, and each colour's against the others, natural logarithm. Chosen: a person reads it off a
    /// few pictures of worn lines; wear changes their colour less than their brightness.
    pub(crate) line_level: [f64; 2],
    /// The same of the carpet. Chosen: as of lines; rolls and dirt differ more.
    pub(crate) carpet_level: [f64; 2],
    /// Gain common to all nominal levels, natural logarithm. Chosen: an exposure that is known to a twentieth of an EV.
    pub(crate) gain: f64,
    /// Level of a surface of which no nominal value is given, natural logarithm. Derived: as good as free.
    pub(crate) free_level: f64,
    /// Blur where none is given, pixels squared. Derived: as good as free.
    pub(crate) free_blur_px2: f64,
    /// Brightness of the carpet seen along its pile against that seen across it, natural logarithm, at grazing incidence.
    /// Chosen; no measurement.
    pub(crate) pile: f64,
    /// Level of a line whose half width is one pixel, natural logarithm. Chosen: a tenth at three pixels, the thinnest whose
    /// level is measured.
    pub(crate) thin_line_level: f64,
    /// Contrast of the carpet's fine texture at the resolution straight down, standard deviation of the natural logarithm of
    /// its brightness, and the factor by which it grows from octave to octave. Measured on one recording by a ray tracer with
    /// nothing hidden: residuals show a contrast of 0.03 from near and of 0.1 at grazing incidence.
    pub(crate) texture: [f64; 2],
    /// Factor between the resolutions at which the texture's contrast is free. Chosen; no measurement.
    pub(crate) texture_octave: f64,
    /// Sheen of the carpet at grazing incidence, as a reflectance like the nominal ones. Chosen; no measurement.
    pub(crate) sheen: f64,
    /// Smallest reflectance of a carpet's colour. Chosen: black paint has as much.
    pub(crate) least_reflectance: f64,
    /// Variance of the nominal blur, pixels squared. Chosen: 0.03 px more or less of a blur of 0.5 px.
    pub(crate) blur_px2: f64,
    /// The same as a part of the nominal variance. Chosen: a width that is known to 15 %.
    pub(crate) blur_share: f64,
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
    /// Exponent of the variance of the noise in brightness. Chosen; no measurement.
    pub(crate) noise_exponent: f64,
}

/// Random field of the reflectance, see [`crate::linear_model::reflectance`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReflectanceThresholds {
    /// Side of the smallest patches of carpet, metres. Chosen: blocks of carpet cover a few centimetres where they are near
    /// and as much as this where they are far.
    pub(crate) smallest_carpet_patch_m: f64,
    /// Side of the smallest patches of lines, metres. Chosen: wear differs from one hand's breadth to the next.
    pub(crate) smallest_line_patch_m: f64,
    /// Increment from a patch to the patches within it that is assumed before anything was seen, natural logarithm. Chosen:
    /// five such scales make 7 %.
    pub(crate) usual_increment: f64,
    /// Number of increments that this assumption counts as. Chosen: as many as the four patches within one.
    pub(crate) prior_increments: f64,
    /// Smallest increment that is believed, natural logarithm. Chosen: far below what a picture shows.
    pub(crate) least_increment: f64,
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
    /// Part of the frames' own errors that lasts longer than the recording, at least: no variogram shows it. Chosen: half of their
    /// variance. Motion capture is known to repeat itself better than it is right, so this is little. Without it, three of 187
    /// drawn worlds with nothing hidden (development) had a mount named that their reference poses were off by.
    pub(crate) lasting_part: f64,
    /// Largest slow errors that are believed, radians and metres. Chosen: twice [`PoseErrorThresholds::usual`], about; what is
    /// off by more is no motion capture, or lines that were taken for others.
    pub(crate) largest: [f64; 2],
    /// Standard deviations of the rank ratio of independent errors by which it has to be smaller where errors last. Derived:
    /// chance in one of twenty.
    pub(crate) least_lasting_score: f64,
    /// Time constants that are tried, seconds. Chosen: from a few pictures on.
    pub(crate) time_constants_s: [f64; 5],
    /// Longest of them, as a part of the recording. Chosen: what lasts longer is a constant to the recording, of which no
    /// variogram tells, and which [`Self::calibration`] stands for.
    pub(crate) longest_time_constant: f64,
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
            line_level: [0.05, 0.015],
            carpet_level: [0.07, 0.04],
            gain: 0.05,
            free_level: 1.0,
            free_blur_px2: 2.0,
            pile: 0.05,
            thin_line_level: 0.3,
            texture: [0.03, 1.41],
            texture_octave: 2.0,
            sheen: 0.05,
            least_reflectance: 0.01,
            blur_px2: 0.03,
            blur_share: 0.3,
            blur_by_width_px2: 0.02,
            blur_shape: 0.12,
            thin_blur_shape: 0.2,
            noise_variance: 0.2,
            noise_exponent: 0.2,
        },
        reflectance: ReflectanceThresholds {
            smallest_carpet_patch_m: 0.25,
            smallest_line_patch_m: 0.125,
            usual_increment: 0.03,
            prior_increments: 4.0,
            least_increment: 0.002,
        },
        pose_error: PoseErrorThresholds {
            initial: [0.01, 0.02],
            usual: [0.0025, 0.003],
            prior_weight: 0.3,
            least: [2e-4, 5e-4],
            free: [0.1, 0.3, 0.3],
        },
        light_range_m: 4.0,
        light_seen_share: 0.02,
        reference_drift: ReferenceDriftThresholds {
            calibration: [0.001, 0.0015],
            lasting_part: 0.7,
            largest: [0.006, 0.006],
            least_lasting_score: 1.645,
            time_constants_s: [0.5, 1.0, 2.0, 4.0, 8.0],
            longest_time_constant: 0.4,
            half_periods: 12,
            lags: 12,
            longest_lag: 0.7,
            least_shrinkage: 0.3,
            least_part: 0.1,
        },
        same_step_s: 0.005,
        reweighting_rounds: 3,
        refitting_rounds: 4,
        tukey_sigmas: 5.0,
        independent_share: 0.15,
        most_prior_share: 0.1,
        cluster_cell_m: 0.5,
        instrument_steps: [2, 3],
    };
}
