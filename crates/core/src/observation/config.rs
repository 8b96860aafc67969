//! Settings of the observation models.

use serde::{Deserialize, Serialize};

use crate::field::FieldDimensions;

/// Which observation model weighs the particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ObservationKind {
    /// The paper's Eq. 2: blurred grey values along the projected lines.
    Gauss,
    /// The paper's Eq. 1: distances from the projected lines to the white lines in the picture.
    Distance,
    /// Lines against their flanks.
    #[default]
    Contrast,
}

/// Settings of the observation models. The defaults are one set for all cameras and fields; `docs/paper.md` has the
/// sweeps they come from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ObservationConfig {
    /// The model.
    pub kind: ObservationKind,
    /// Distance between samples on the ground, metres.
    pub spacing_m: f64,
    /// The same in line widths; the larger of the two is used. Lines of a large field are wide: samples closer than that
    /// say the same thing twice.
    pub spacing_line_widths: f64,
    /// Sigma of the Gaussian blur, pixels.
    pub blur_sigma_px: f32,
    /// α of Eq. 1 and Eq. 2, grey levels and pixels; positive, see `docs/paper.md`.
    pub alpha: f64,
    /// Whether everything outside the field's border counts as black.
    pub mask_border: bool,
    /// Distances in the distance model are cut here, pixels. At most 31.
    pub max_distance_px: f32,
    /// Nearness, as a fraction of `max_distance_px`, that speaks neither for nor against a line in the distance model. The
    /// paper has 0.
    pub distance_neutral: f64,
    /// Log-weight of a line sample that is found.
    pub contrast_gain: f64,
    /// Contrast that speaks neither for nor against a line. What is in view and not found counts against a pose by it.
    pub contrast_neutral: f64,
}

impl ObservationConfig {
    /// The defaults of a model.
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

    /// The contrast model with fewer samples, for searching and for checking what the filter found.
    pub(crate) fn coarse_contrast() -> Self {
        let config = Self::new(ObservationKind::Contrast);
        Self {
            spacing_line_widths: 1.6,
            contrast_gain: 1.6 * config.contrast_gain,
            blur_sigma_px: 0.0,
            ..config
        }
    }

    /// A cheap score with a basin wide enough for a grid, for exhaustive search: how near samples are to white pixels,
    /// minus what chance would give, counted in samples.
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

    /// Distance between samples on a field, metres.
    pub(super) fn spacing_in(&self, field: &FieldDimensions) -> f64 {
        self.spacing_m.max(self.spacing_line_widths * field.line_width_m)
    }
}

impl Default for ObservationConfig {
    fn default() -> Self {
        Self::new(ObservationKind::default())
    }
}
