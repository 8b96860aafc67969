//! What an observation model reads along the lines, and how it becomes a log-weight: the part common to all devices.

use std::ops::Range;

use glam::DVec2;
use image::GrayImage;

use super::{
    block::LineBlock,
    config::{ObservationConfig, ObservationKind},
    interpolation::CameraLimits,
    kernel::ContrastScale,
    samples::Samples,
};
use crate::{
    camera::{Camera, KernelCamera},
    field::{FieldDimensions, LineSample, sample_lines},
    preprocess::{DISTANCE_UNITS_PER_PX, Prepared, WhiteLevels, distance_field, gaussian_blur},
};

/// Distance of the flanks from the line's centre, in line widths.
const FLANK_WIDTHS: f64 = 1.0;
/// Minimum distance of contrast samples from any other line, in line widths: nearer ones would have white flanks.
const CLEARANCE_WIDTHS: f64 = 1.8;
/// Sum of two values below which they are noise, grey levels.
pub(super) const DARK_LEVEL: f32 = 16.0;
/// Width in the picture below which lines are not resolved and do not count, pixels.
const MIN_WIDTH_PX: f32 = 0.7;
/// Width in the picture from which lines count fully, pixels.
const FULL_WIDTH_PX: f32 = 3.0;
/// Area of a sample's piece of line in the picture from which the sample counts fully, square pixels.
const FULL_AREA_PX: f64 = 8.0;

/// Samples of a field's lines.
#[derive(Debug, Clone)]
pub(super) enum Lines {
    /// Their centres.
    Plain(Samples<1>),
    /// Centre, left flank and right flank.
    Flanked(Samples<3>),
}

/// Camera and line samples of a field, with the settings of an observation model.
#[derive(Debug, Clone)]
pub struct LineModel {
    /// Settings of the observation model.
    pub config: ObservationConfig,
    /// Camera in the form that the scoring loops use.
    pub camera: KernelCamera,
    pub(super) lines: Lines,
    relative_area: f32,
}

impl LineModel {
    /// Prepares the samples of a field's lines for a camera.
    pub fn new(camera: &Camera, field: &FieldDimensions, config: ObservationConfig) -> Self {
        let samples = sample_lines(field, config.spacing_in(field));
        let area_px = camera.fx * camera.fy * field.line_width_m * config.spacing_in(field);
        let relative_area = (area_px / FULL_AREA_PX) as f32;
        let camera = KernelCamera::new(camera);
        let limits = CameraLimits::new(&camera);
        let lines = match config.kind {
            ObservationKind::Contrast => Lines::Flanked(flanked(&samples, field.line_width_m, &limits)),
            _ => Lines::Plain(plain(&samples, &limits)),
        };
        Self { config, camera, lines, relative_area }
    }

    /// Returns the line samples.
    pub fn blocks(&self) -> Vec<LineBlock> {
        match &self.lines {
            Lines::Plain(samples) => samples.blocks([0, 0]).collect(),
            Lines::Flanked(samples) => samples.blocks([0, 1]).collect(),
        }
    }

    /// Returns the contrast model's parameters for a picture with these levels.
    pub fn contrast_scale(&self, levels: &WhiteLevels) -> ContrastScale {
        ContrastScale {
            per_contrast: 1.0 / levels.michelson(DARK_LEVEL),
            dark_level: DARK_LEVEL,
            min_width_px: MIN_WIDTH_PX,
            per_width_px: 1.0 / (FULL_WIDTH_PX - MIN_WIDTH_PX),
            relative_area: self.relative_area,
        }
    }

    /// Returns the factors by which the two sums along a pose's lines are multiplied to give its log-weight.
    pub fn per_sum(&self) -> [f64; 2] {
        let ObservationConfig {
            alpha,
            contrast_gain,
            contrast_neutral,
            max_distance_px,
            distance_neutral,
            ..
        } = self.config;
        match self.config.kind {
            ObservationKind::Gauss => [1.0 / alpha, 0.0],
            ObservationKind::Distance => {
                let per_px = 1.0 / alpha;
                [
                    per_px / f64::from(DISTANCE_UNITS_PER_PX),
                    -per_px * distance_neutral * f64::from(max_distance_px),
                ]
            }
            ObservationKind::Contrast => [contrast_gain, -contrast_gain * contrast_neutral],
        }
    }

    /// Returns the log-weight for the two sums along a pose's lines.
    pub fn log_weight(&self, sums: [f32; 2]) -> f64 {
        let [per_value, per_seen] = self.per_sum();
        let [value, seen] = sums.map(f64::from);
        per_value * value + per_seen * seen
    }

    /// Returns the image that the model samples.
    pub fn image(&self, picture: &Prepared) -> GrayImage {
        let mut image = match self.config.kind {
            ObservationKind::Gauss => gaussian_blur(&picture.luma(), self.config.blur_sigma_px),
            ObservationKind::Distance => nearness(&distance_field(&picture.evidence()), self.nearness_cap()),
            ObservationKind::Contrast => gaussian_blur(&picture.whiteness, self.config.blur_sigma_px),
        };
        if self.is_masked() {
            picture.border.mask(&mut image);
        }
        image
    }

    /// Returns whether everything outside the field's border counts as black. Never for the contrast model: it compares
    /// a line with its flanks, and masking would darken these.
    pub fn is_masked(&self) -> bool {
        self.config.mask_border && self.config.kind != ObservationKind::Contrast
    }

    /// Returns the maximum distance, in [`DISTANCE_UNITS_PER_PX`].
    pub fn nearness_cap(&self) -> u8 {
        (self.config.max_distance_px * DISTANCE_UNITS_PER_PX).clamp(0.0, 255.0) as u8
    }
}

/// Returns the cap minus the distance to the nearest white pixel, at least 0.
fn nearness(distances: &GrayImage, cap: u8) -> GrayImage {
    let mut field = distances.clone();
    field.iter_mut().for_each(|value| *value = cap.saturating_sub(*value));
    field
}

/// Returns the centres of samples.
pub(super) fn plain(samples: &[LineSample], limits: &CameraLimits) -> Samples<1> {
    let points: Vec<[DVec2; 1]> = samples.iter().map(|sample| [sample.point_in_world]).collect();
    Samples::new(runs(samples).map(|run| &points[run]), limits)
}

/// Returns centre, left flank and right flank of the samples whose flanks are on no other line.
pub(super) fn flanked(samples: &[LineSample], line_width_m: f64, limits: &CameraLimits) -> Samples<3> {
    let is_clear = |sample: &&LineSample| sample.clearance_m > CLEARANCE_WIDTHS * line_width_m;
    let clear: Vec<LineSample> = samples.iter().filter(is_clear).copied().collect();
    let points = |sample: &LineSample| {
        let flank = FLANK_WIDTHS * line_width_m * sample.normal_in_world();
        let centre = sample.point_in_world;
        [centre, centre + flank, centre - flank]
    };
    let points: Vec<[DVec2; 3]> = clear.iter().map(points).collect();
    Samples::new(runs(&clear).map(|run| &points[run]), limits)
}

/// Returns where the samples of each line are.
fn runs(samples: &[LineSample]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    samples.chunk_by(|a, b| a.curve == b.curve).map(move |run| {
        end += run.len();
        end - run.len()..end
    })
}
