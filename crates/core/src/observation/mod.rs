//! Observation models: how well a picture fits a pose, as the log-weights of the paper's two models and of our own.
//!
//! | model | log-weight of a pose |
//! |---|---|
//! | [`ObservationKind::Gauss`] | Σ blurred grey value / α along all projected lines (Eq. 2) |
//! | [`ObservationKind::Distance`] | Σ (cap − distance to the nearest white line) / α (Eq. 1 with the sign reversed) |
//! | [`ObservationKind::Contrast`] | gain · Σ weight · (contrast of line against flanks − neutral) |

mod block;
mod config;
mod interpolation;
mod kernel;
mod model;
mod normal_search;
mod path;
mod samples;

use std::slice;

use rayon::prelude::*;

use self::model::Lines;
pub use self::{
    block::{LineBlock, SamplePoints},
    config::{ObservationConfig, ObservationKind},
    interpolation::Limits,
    kernel::{CameraFromGround, ContrastScale},
    model::LineModel,
    normal_search::NormalSearch,
};
use crate::{
    backend_error::BackendError,
    camera::Camera,
    field::FieldDimensions,
    pose::CameraPose,
    preprocess::{Prepared, Texture, WhiteLevels},
};

/// Number of poses scored by one task: enough work to outweigh the cost of starting it.
const POSES_PER_TASK: usize = 16;

/// Scores poses against the picture that was loaded last. The particle filter depends on this trait alone, so that the
/// same filter runs with any model.
///
/// A call fails if its device does; the CPU never fails.
pub trait Scorer: Send + Sync {
    /// Loads a new picture. Fails if the device does.
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError>;
    /// Returns the log-weight of every pose, up to one constant for the whole picture. Fails if the device does.
    fn log_weights(&self, poses: &[CameraPose]) -> Result<Vec<f64>, BackendError>;
}

/// Observation models on the CPU.
#[derive(Debug, Clone)]
pub struct CpuScorer {
    model: LineModel,
    texture: Texture,
    scale: ContrastScale,
}

impl CpuScorer {
    /// Prepares the samples of a field's lines for a camera.
    pub fn new(camera: &Camera, field: &FieldDimensions, config: ObservationConfig) -> Self {
        let model = LineModel::new(camera, field, config);
        let scale = model.contrast_scale(&WhiteLevels::default());
        Self { model, texture: Texture::default(), scale }
    }

    /// Returns the number of line samples scored for each pose.
    pub fn samples(&self) -> usize {
        self.model.blocks().iter().map(|block| block.samples.len()).sum()
    }

    /// Returns the fraction of the line in view that the picture shows where the pose projects it: 1 if every line is
    /// found, about 0 for a random pose. Returns `None` if no line is in view. Contrast model only.
    pub fn line_fraction(&self, pose: CameraPose) -> Option<f64> {
        let [contrast, weight] = self.sums(&pose);
        (weight >= 1.0).then(|| f64::from(contrast / weight))
    }

    /// Returns the picture loaded last, as the model reads it.
    pub fn texture(&self) -> &Texture {
        &self.texture
    }

    /// Returns two sums along the lines of a pose: Σ value and the number of samples seen, or for the contrast model Σ
    /// weight · contrast and Σ weight.
    pub fn sums(&self, pose: &CameraPose) -> [f32; 2] {
        self.sums_of(slice::from_ref(pose))[0]
    }

    /// Returns [`Self::sums`] of every pose.
    fn sums_of(&self, poses: &[CameraPose]) -> Vec<[f32; 2]> {
        let LineModel { camera, lines, .. } = &self.model;
        let poses: Vec<CameraFromGround> = poses.iter().copied().map(CameraFromGround::new).collect();
        match lines {
            Lines::Plain(samples) => kernel::sum_along_lines(&self.texture, camera, &poses, samples),
            Lines::Flanked(samples) => {
                kernel::contrast_along_lines(&self.texture, camera, &poses, samples, self.scale)
            }
        }
    }

    /// Loads a new picture, as [`Scorer::load`]; the CPU never fails.
    pub fn set_picture(&mut self, picture: &Prepared) {
        self.texture.repack(&self.model.image(picture));
        self.scale = self.model.contrast_scale(&picture.levels);
    }

    /// Returns the log-weights of poses, as [`Scorer::log_weights`]; the CPU never fails.
    pub fn log_weights_of(&self, poses: &[CameraPose]) -> Vec<f64> {
        let sums = poses.par_chunks(POSES_PER_TASK).flat_map_iter(|poses| self.sums_of(poses));
        sums.map(|sums| self.model.log_weight(sums)).collect()
    }

    /// Returns the log-weight of one pose.
    pub(crate) fn log_weight(&self, pose: &CameraPose) -> f64 {
        self.model.log_weight(self.sums(pose))
    }
}

impl Scorer for CpuScorer {
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError> {
        self.set_picture(picture);
        Ok(())
    }

    fn log_weights(&self, poses: &[CameraPose]) -> Result<Vec<f64>, BackendError> {
        Ok(self.log_weights_of(poses))
    }
}

#[cfg(test)]
mod tests;
