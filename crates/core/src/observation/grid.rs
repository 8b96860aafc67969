//! A coarse score for exhaustive search: cheap, and with a basin wide enough for a grid.

use super::{
    kernel::{self, CameraFromGround, GroundPoints},
    lens::KernelCamera,
    nearness,
};
use crate::{
    camera::Camera,
    field::{FieldDimensions, sample_lines},
    pose::CameraPose,
    preprocess::{DISTANCE_UNITS_PER_PX, Prepared, Texture},
};

/// Samples over all lines of the field.
const SAMPLES: f64 = 260.0;
/// Distances are cut here, pixels.
const MAX_DISTANCE_PX: f32 = 24.0;
/// Nearness, as a fraction of the cap, that a place chosen at random has.
const NEUTRAL: f64 = 0.45;

/// Sums how near projected samples are to white pixels, minus what chance would give.
#[derive(Debug, Clone)]
pub struct GridScorer {
    camera: KernelCamera,
    points: GroundPoints,
    texture: Texture,
}

impl GridScorer {
    /// Prepares the samples of a field's lines for a camera.
    pub fn new(camera: &Camera, field: &FieldDimensions) -> Self {
        let total_m: f64 = field.curves().iter().map(crate::field::Curve::length_m).sum();
        let samples = sample_lines(field, total_m / SAMPLES);
        let points = GroundPoints::new(samples.iter().map(|sample| sample.point_in_world));
        Self { camera: KernelCamera::new(camera), points, texture: Texture::default() }
    }

    /// Takes over a new picture.
    pub fn load(&mut self, picture: &Prepared) {
        let mut image = nearness(picture, MAX_DISTANCE_PX);
        picture.border.mask(&mut image);
        self.texture = Texture::pack(&image);
    }

    /// Score of a pose, in samples found beyond chance.
    pub fn log_weight(&self, pose: CameraPose) -> f64 {
        let pose = CameraFromGround::new(pose);
        let [sum, seen] =
            kernel::sum_along_lines(&self.texture, &self.camera, &pose, &self.points).map(f64::from);
        sum / f64::from(MAX_DISTANCE_PX * DISTANCE_UNITS_PER_PX) - NEUTRAL * seen
    }
}
