//! Settings of the observation models.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use crate::{
    field::FieldDimensions,
    names::{UnknownName, by_name},
    setters::setters,
};

/// Observation model that weighs the particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ObservationKind {
    /// Blurred grey values along the projected lines: the paper's Eq. 2.
    Gauss,
    /// Distances from the projected lines to the white lines in the picture: the paper's Eq. 1.
    Distance,
    /// Contrast of the projected lines against the carpet on both sides.
    #[default]
    Contrast,
}

impl ObservationKind {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 3] = [Self::Gauss, Self::Distance, Self::Contrast];

    /// Its name in options and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gauss => "gauss",
            Self::Distance => "distance",
            Self::Contrast => "contrast",
        }
    }

    /// What it is, in a line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Gauss => "The paper's Eq. 2: grey values on the projected lines",
            Self::Distance => "The paper's Eq. 1: distances from projected to white lines",
            Self::Contrast => "Lines against their flanks, all six degrees of freedom, sub-pixel fit",
        }
    }
}

impl fmt::Display for ObservationKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for ObservationKind {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("observation model", &Self::ALL, Self::name, name)
    }
}

/// Settings of the observation models. The same defaults serve all cameras and fields; `docs/paper.md` has the
/// parameter sweeps behind them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct ObservationConfig {
    /// Observation model.
    pub kind: ObservationKind,
    /// Distance between samples on the ground, 0.02 m: less than half a line's width on the smallest field.
    pub spacing_m: f64,
    /// The same distance in line widths, 0, and 1 for `contrast`; the larger of the two is used. The lines of a large field
    /// are wide, and samples closer together than that are redundant.
    pub spacing_line_widths: f64,
    /// Standard deviation of the Gaussian blur, 1 px (measured: `docs/figures/sweep.md`), and 0.7 px for `contrast`, whose
    /// flanks must not run into the line.
    pub blur_sigma_px: f32,
    /// α of Eq. 1, 100 px, and of Eq. 2, 300 grey levels (measured: `docs/figures/sweep.md`); positive, see `docs/paper.md`.
    pub alpha: f64,
    /// Whether everything outside the field's border counts as black, true (measured: `docs/figures/sweep.md`).
    pub mask_border: bool,
    /// Maximum distance in the distance model, at which all larger ones are clipped, 20 px: farther away, the nearest white
    /// pixel is another line's. At most 31.
    pub max_distance_px: f32,
    /// Nearness to a white line, as a fraction of `max_distance_px`, that is neither evidence for nor against a line in
    /// the distance model, 0 as in the paper.
    pub distance_neutral: f64,
    /// Log-weight of a line sample that is found, 0.4: neighbouring samples are not independent.
    pub contrast_gain: f64,
    /// Contrast that is neither evidence for nor against a line, 0.15: more than noise makes, less than any line. Every
    /// sample in view that is not found therefore counts against a pose.
    pub contrast_neutral: f64,
}

setters!(ObservationConfig {
    with_kind: kind = ObservationKind,
    with_spacing_m: spacing_m = f64,
    with_spacing_line_widths: spacing_line_widths = f64,
    with_blur_sigma_px: blur_sigma_px = f32,
    with_alpha: alpha = f64,
    with_mask_border: mask_border = bool,
    with_max_distance_px: max_distance_px = f32,
    with_distance_neutral: distance_neutral = f64,
    with_contrast_gain: contrast_gain = f64,
    with_contrast_neutral: contrast_neutral = f64,
});

impl ObservationConfig {
    /// Returns the defaults of a model.
    pub fn new(kind: ObservationKind) -> Self {
        let common = Self {
            kind,
            spacing_m: 0.02,
            spacing_line_widths: 0.0,
            blur_sigma_px: 1.0,
            alpha: 300.0,
            mask_border: true,
            max_distance_px: 20.0,
            distance_neutral: 0.0,
            contrast_gain: 0.4,
            contrast_neutral: 0.15,
        };
        match kind {
            ObservationKind::Gauss => common,
            ObservationKind::Distance => Self { alpha: 100.0, ..common },
            ObservationKind::Contrast => Self { spacing_line_widths: 1.0, blur_sigma_px: 0.7, ..common },
        }
    }

    /// Returns the contrast model with fewer samples, for searching and for checking the filter's result.
    pub(crate) fn coarse_contrast() -> Self {
        let config = Self::new(ObservationKind::Contrast);
        Self {
            spacing_line_widths: 1.6,
            contrast_gain: 1.6 * config.contrast_gain,
            blur_sigma_px: 0.0,
            ..config
        }
    }

    /// Returns a cheap distance model for exhaustive search, with a basin wide enough for a grid: how near the samples
    /// are to white pixels, minus what chance would give, in units of samples.
    pub fn grid(field: &FieldDimensions) -> Self {
        const SAMPLES: f64 = 260.0;
        const MAX_DISTANCE_PX: f32 = 24.0;
        let total_m: f64 = field.curves().iter().map(crate::field::Curve::length_m).sum();
        Self {
            spacing_m: total_m / SAMPLES,
            max_distance_px: MAX_DISTANCE_PX,
            distance_neutral: 0.45,
            alpha: f64::from(MAX_DISTANCE_PX),
            ..Self::new(ObservationKind::Distance)
        }
    }

    /// Returns the distance between samples on a field, metres.
    pub(super) fn spacing_in(&self, field: &FieldDimensions) -> f64 {
        self.spacing_m.max(self.spacing_line_widths * field.line_width_m)
    }
}

impl Default for ObservationConfig {
    fn default() -> Self {
        Self::new(ObservationKind::default())
    }
}
