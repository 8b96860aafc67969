//! What an observation model reads along the lines, and what it makes of it: the part that is the same on every device.

use image::GrayImage;

use super::{
    config::{ObservationConfig, ObservationKind},
    kernel::{ContrastScale, GroundPoints, LinePoints},
};
use crate::{
    camera::{Camera, KernelCamera},
    field::{FieldDimensions, LineSample, sample_lines},
    preprocess::{DISTANCE_UNITS_PER_PX, Prepared, WhiteLevels, distance_field, gaussian_blur},
};

/// Flanks lie this many line widths from the line's centre.
const FLANK_WIDTHS: f64 = 1.0;
/// Contrast samples nearer than this to another line, in line widths, are left out: their flanks would be white.
const CLEARANCE_WIDTHS: f64 = 1.8;
/// Sums of two values below this are noise, grey levels.
pub(super) const DARK_LEVEL: f32 = 16.0;
/// Lines narrower than this in the picture, pixels, are not resolved and do not count.
const MIN_WIDTH_PX: f32 = 0.7;
/// Lines wider than this, pixels, count fully.
const FULL_WIDTH_PX: f32 = 3.0;
/// A sample whose piece of line covers this area in the picture, square pixels, counts fully.
const FULL_AREA_PX: f64 = 8.0;

/// A camera and the samples of a field's lines, with the settings of an observation model.
#[derive(Debug, Clone)]
pub struct LineModel {
    /// The settings.
    pub config: ObservationConfig,
    /// The camera as the scoring loops see it.
    pub camera: KernelCamera,
    pub(super) points: LinePoints,
    relative_area: f32,
}

impl LineModel {
    /// Prepares the samples of a field's lines for a camera.
    pub fn new(camera: &Camera, field: &FieldDimensions, config: ObservationConfig) -> Self {
        let samples = sample_lines(field, config.spacing_in(field));
        let points = match config.kind {
            ObservationKind::Contrast => line_points(&samples, field.line_width_m),
            _ => LinePoints { centre: ground_points(&samples, 0.0), ..Default::default() },
        };
        let area_px = camera.fx * camera.fy * field.line_width_m * config.spacing_in(field);
        let relative_area = (area_px / FULL_AREA_PX) as f32;
        Self { config, camera: KernelCamera::new(camera), points, relative_area }
    }

    /// Centres of the line samples on the ground, metres, and beside each of them the place on its left flank; the right
    /// flank mirrors it. Models that look at no flanks have the centre there too.
    pub fn places(&self) -> Vec<[[f32; 2]; 2]> {
        let flanks = if self.points.left.blocks.is_empty() { &self.points.centre } else { &self.points.left };
        self.points.centre.points().zip(flanks.points()).map(|(centre, flank)| [centre, flank]).collect()
    }

    /// What the contrast model needs to know of a picture with these levels.
    pub fn contrast_scale(&self, levels: &WhiteLevels) -> ContrastScale {
        ContrastScale {
            per_contrast: 1.0 / levels.michelson(DARK_LEVEL),
            dark_level: DARK_LEVEL,
            min_width_px: MIN_WIDTH_PX,
            per_width_px: 1.0 / (FULL_WIDTH_PX - MIN_WIDTH_PX),
            relative_area: self.relative_area,
        }
    }

    /// Factors of the two sums along a pose's lines that add up to its log-weight.
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

    /// The log-weight that the two sums along a pose's lines come to.
    pub fn log_weight(&self, sums: [f32; 2]) -> f64 {
        let [per_value, per_seen] = self.per_sum();
        let [value, seen] = sums.map(f64::from);
        per_value * value + per_seen * seen
    }

    /// The picture that the model looks values up in.
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

    /// Whether what lies outside the field's border counts as black. Contrast compares a line with its flanks, which that
    /// would darken.
    pub fn is_masked(&self) -> bool {
        self.config.mask_border && self.config.kind != ObservationKind::Contrast
    }

    /// Distances are cut here, in [`DISTANCE_UNITS_PER_PX`].
    pub fn nearness_cap(&self) -> u8 {
        (self.config.max_distance_px * DISTANCE_UNITS_PER_PX).clamp(0.0, 255.0) as u8
    }
}

/// The cap minus the distance to the next white pixel, at least 0.
fn nearness(distances: &GrayImage, cap: u8) -> GrayImage {
    let mut field = distances.clone();
    field.iter_mut().for_each(|value| *value = cap.saturating_sub(*value));
    field
}

pub(super) fn ground_points(samples: &[LineSample], across_m: f64) -> GroundPoints {
    GroundPoints::new(
        samples.iter().map(|sample| sample.point_in_world + across_m * sample.normal_in_world()),
    )
}

pub(super) fn line_points(samples: &[LineSample], line_width_m: f64) -> LinePoints {
    let clear: Vec<LineSample> = samples
        .iter()
        .filter(|sample| sample.clearance_m > CLEARANCE_WIDTHS * line_width_m)
        .copied()
        .collect();
    let flank = FLANK_WIDTHS * line_width_m;
    LinePoints {
        centre: ground_points(&clear, 0.0),
        left: ground_points(&clear, flank),
        right: ground_points(&clear, -flank),
    }
}
