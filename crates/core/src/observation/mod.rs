//! How well a picture fits a pose: log-weights of the paper's two observation models and of our own.
//!
//! | model | log-weight of a pose |
//! |---|---|
//! | [`ObservationKind::Gauss`] | Σ blurred grey value / α along all projected lines (Eq. 2) |
//! | [`ObservationKind::Distance`] | Σ (cap − distance to the next white line) / α (Eq. 1, its sign turned) |
//! | [`ObservationKind::Contrast`] | gain · Σ weight · (contrast of line against flanks − neutral) |

mod grid;
mod kernel;
mod lens;
mod normal_search;

use image::GrayImage;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub use self::{grid::GridScorer, normal_search::NormalSearch};
use self::{
    kernel::{CameraFromGround, ContrastScale, GroundPoints, LinePoints},
    lens::KernelCamera,
};
use crate::{
    camera::Camera,
    field::{FieldDimensions, LineSample, sample_lines},
    pose::CameraPose,
    preprocess::{DISTANCE_UNITS_PER_PX, Prepared, Texture, distance_field, gaussian_blur},
};

/// Poses scored by one task: enough work to outweigh handing it over.
const POSES_PER_TASK: usize = 16;
/// Flanks lie this many line widths from the line's centre.
const FLANK_WIDTHS: f64 = 1.0;
/// Contrast samples nearer than this to another line, in line widths, are left out: their flanks would be white.
const CLEARANCE_WIDTHS: f64 = 1.8;

/// Sums of two values below this are noise, grey levels.
const DARK_LEVEL: f32 = 16.0;

/// Lines narrower than this in the picture, pixels, are not resolved and do not count.
const MIN_WIDTH_PX: f32 = 0.7;
/// Lines wider than this, pixels, count fully.
const FULL_WIDTH_PX: f32 = 3.0;
/// A sample whose piece of line covers this area in the picture, square pixels, counts fully.
const FULL_AREA_PX: f64 = 8.0;

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
            contrast_gain: 0.4,
            contrast_neutral: 0.15,
        };
        match kind {
            ObservationKind::Gauss => common,
            ObservationKind::Distance => Self { alpha: 100.0, ..common },
            ObservationKind::Contrast => Self { spacing_line_widths: 1.0, blur_sigma_px: 0.7, ..common },
        }
    }
}

impl ObservationConfig {
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

    fn spacing_in(&self, field: &FieldDimensions) -> f64 {
        self.spacing_m.max(self.spacing_line_widths * field.line_width_m)
    }
}

impl Default for ObservationConfig {
    fn default() -> Self {
        Self::new(ObservationKind::default())
    }
}

/// Scores poses against the picture that was loaded last. The particle filter knows only this, so that the same filter
/// runs on other hardware.
pub trait Scorer: Send + Sync {
    /// Takes over a new picture.
    fn load(&mut self, picture: &Prepared);
    /// Log-weight of every pose, up to one constant for the whole picture.
    fn log_weights(&self, poses: &[CameraPose]) -> Vec<f64>;
}

/// The observation models on the CPU.
#[derive(Debug, Clone)]
pub struct CpuScorer {
    config: ObservationConfig,
    camera: KernelCamera,
    points: LinePoints,
    texture: Texture,
    contrast: f32,
    relative_area: f32,
}

impl CpuScorer {
    /// Prepares the samples of a field's lines for a camera.
    pub fn new(camera: &Camera, field: &FieldDimensions, config: ObservationConfig) -> Self {
        let samples = sample_lines(field, config.spacing_in(field));
        let points = match config.kind {
            ObservationKind::Contrast => line_points(&samples, field.line_width_m),
            _ => LinePoints { centre: ground_points(&samples, 0.0), ..Default::default() },
        };
        let area_px = camera.fx * camera.fy * field.line_width_m * config.spacing_in(field);
        Self {
            config,
            camera: KernelCamera::new(camera),
            points,
            texture: Texture::default(),
            contrast: 1.0,
            relative_area: (area_px / FULL_AREA_PX) as f32,
        }
    }

    /// Number of line samples scored for each pose.
    pub fn samples(&self) -> usize {
        self.points.centre.count()
    }

    /// Fraction of the line in view that the picture shows where the pose puts it: 1 where every line is found, 0 for a
    /// pose chosen at random. `None` where no line is in view. Contrast model only.
    pub fn line_fraction(&self, pose: CameraPose) -> Option<f64> {
        let [contrast, weight] = self.contrast_sums(&pose);
        (weight >= 1.0).then(|| f64::from(contrast / weight))
    }

    /// The picture loaded last, as the model reads it.
    pub(crate) fn texture(&self) -> &Texture {
        &self.texture
    }

    fn contrast_sums(&self, pose: &CameraPose) -> [f32; 2] {
        let scale = ContrastScale {
            per_contrast: 1.0 / self.contrast,
            dark_level: DARK_LEVEL,
            min_width_px: MIN_WIDTH_PX,
            per_width_px: 1.0 / (FULL_WIDTH_PX - MIN_WIDTH_PX),
            relative_area: self.relative_area,
        };
        kernel::contrast_along_lines(
            &self.texture,
            &self.camera,
            &CameraFromGround::new(*pose),
            &self.points,
            scale,
        )
    }

    /// Log-weight of one pose.
    pub(crate) fn log_weight(&self, pose: &CameraPose) -> f64 {
        match self.config.kind {
            ObservationKind::Gauss => self.sum(pose) / self.config.alpha,
            ObservationKind::Distance => {
                self.sum(pose) / f64::from(DISTANCE_UNITS_PER_PX) / self.config.alpha
            }
            ObservationKind::Contrast => {
                let [contrast, weight] = self.contrast_sums(pose).map(f64::from);
                self.config.contrast_gain * (contrast - self.config.contrast_neutral * weight)
            }
        }
    }

    fn sum(&self, pose: &CameraPose) -> f64 {
        let pose = CameraFromGround::new(*pose);
        f64::from(kernel::sum_along_lines(&self.texture, &self.camera, &pose, &self.points.centre)[0])
    }
}

impl Scorer for CpuScorer {
    fn load(&mut self, picture: &Prepared) {
        let mut image = match self.config.kind {
            ObservationKind::Gauss => gaussian_blur(&picture.luma, self.config.blur_sigma_px),
            ObservationKind::Distance => nearness(picture, self.config.max_distance_px),
            ObservationKind::Contrast => gaussian_blur(&picture.whiteness, self.config.blur_sigma_px),
        };
        // Contrast compares a line with its flanks, which the mask would darken.
        if self.config.mask_border && self.config.kind != ObservationKind::Contrast {
            picture.border.mask(&mut image);
        }
        self.contrast = picture.levels.michelson(DARK_LEVEL);
        self.texture = Texture::pack(&image);
    }

    fn log_weights(&self, poses: &[CameraPose]) -> Vec<f64> {
        poses.par_iter().with_min_len(POSES_PER_TASK).map(|pose| self.log_weight(pose)).collect()
    }
}

/// The cap minus the distance to the next white pixel, in [`DISTANCE_UNITS_PER_PX`].
fn nearness(picture: &Prepared, max_distance_px: f32) -> GrayImage {
    let cap = (max_distance_px * DISTANCE_UNITS_PER_PX).clamp(0.0, 255.0) as u8;
    let mut field = distance_field(&picture.evidence());
    field.iter_mut().for_each(|value| *value = cap.saturating_sub(*value));
    field
}

fn ground_points(samples: &[LineSample], across_m: f64) -> GroundPoints {
    GroundPoints::new(
        samples.iter().map(|sample| sample.point_in_world + across_m * sample.normal_in_world()),
    )
}

fn line_points(samples: &[LineSample], line_width_m: f64) -> LinePoints {
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

#[cfg(test)]
mod tests;
