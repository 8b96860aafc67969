//! Literal implementation of Eq. 1: from every projected sample it searches both ways across the projected line for the
//! first white pixel.
//!
//! [`super::ObservationKind::Distance`] reads the distance to the nearest white pixel in any direction from a distance
//! field, which is many times faster; `docs/paper.md` compares the two.

use glam::DVec2;
use image::GrayImage;
use rayon::prelude::*;

use super::{ObservationConfig, POSES_PER_TASK, Scorer};
use crate::{
    backend_error::BackendError,
    camera::Camera,
    field::{FieldDimensions, LineSample, sample_lines},
    pose::CameraPose,
    preprocess::Prepared,
};

/// Step along a line that gives its direction in the picture, metres.
const TANGENT_STEP_M: f64 = 0.01;

/// Scores poses by searching along the normals of the projected lines.
#[derive(Debug, Clone)]
pub struct NormalSearch {
    camera: Camera,
    samples: Vec<LineSample>,
    evidence: GrayImage,
    max_distance_px: u32,
    alpha: f64,
}

impl NormalSearch {
    /// Takes spacing, cap and α from the settings of the distance model.
    pub fn new(camera: &Camera, field: &FieldDimensions, config: ObservationConfig) -> Self {
        Self {
            camera: camera.clone(),
            samples: sample_lines(field, config.spacing_in(field)),
            evidence: GrayImage::default(),
            max_distance_px: config.max_distance_px as u32,
            alpha: config.alpha,
        }
    }

    fn log_weight(&self, pose: CameraPose) -> f64 {
        let distances = self.samples.iter().filter_map(|sample| self.distance_px(pose, sample));
        distances.map(|distance_px| f64::from(self.max_distance_px - distance_px)).sum::<f64>() / self.alpha
    }

    /// Returns the distance from a projected sample to the nearest white pixel across the line, pixels, at most the
    /// cap. Returns `None` if the sample is out of view.
    fn distance_px(&self, pose: CameraPose, sample: &LineSample) -> Option<u32> {
        let project = |point: DVec2| self.camera.project(pose.camera_from_world(point.extend(0.0))).ok();
        let pixel = project(sample.point_in_world)?;
        let ahead = project(sample.point_in_world + TANGENT_STEP_M * sample.tangent_in_world)?;
        let normal = (ahead - pixel).perp().try_normalize()?;
        let white = |pixel: DVec2| {
            let [u, v] = pixel.round().to_array();
            // The casts saturate: samples left of or above the picture are excluded first.
            u >= 0.0
                && v >= 0.0
                && self.evidence.get_pixel_checked(u as u32, v as u32).is_some_and(|p| p.0[0] > 0)
        };
        let found = |distance: &u32| {
            let across = f64::from(*distance) * normal;
            white(pixel + across) || white(pixel - across)
        };
        Some((0..self.max_distance_px).find(found).unwrap_or(self.max_distance_px))
    }
}

impl Scorer for NormalSearch {
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError> {
        self.evidence = picture.evidence();
        Ok(())
    }

    fn log_weights(&self, poses: &[CameraPose]) -> Result<Vec<f64>, BackendError> {
        Ok(poses.par_iter().with_min_len(POSES_PER_TASK).map(|pose| self.log_weight(*pose)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        mount::MountPose,
        observation::{CpuScorer, ObservationKind},
        preprocess::Preprocessor,
        test_scene,
    };

    /// The nearest white pixel in any direction is never farther away than the nearest one across the line.
    #[test]
    fn the_distance_field_is_a_lower_bound_that_is_met_on_the_lines() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let config = ObservationConfig::new(ObservationKind::Distance);
        let (mut across, mut any) =
            (NormalSearch::new(&camera, &field, config), CpuScorer::new(&camera, &field, config));
        for pose in test_scene::poses() {
            let picture = Preprocessor::new(&camera, field.line_width_m)
                .prepare(test_scene::render(&camera, pose, &field), MountPose::of(pose));
            across.load(&picture).unwrap();
            any.load(&picture).unwrap();
            let beside = [0.0, 0.03, 0.1, 0.5].map(|dx| CameraPose { x_m: pose.x_m + dx, ..pose });
            let (across, any) = (across.log_weights(&beside).unwrap(), any.log_weights(&beside).unwrap());
            for (across, any) in across.iter().zip(&any) {
                assert!(*across <= 1.03 * any, "{across} along the normals, {any} in any direction");
            }
            // Far lines are white in places only: there may be a white pixel along the line, but none across it.
            assert!(across[0] > 0.6 * any[0], "{} and {} in the right place", across[0], any[0]);
            assert!(across.windows(2).all(|pair| pair[0] > pair[1]), "worse with the distance: {across:?}");
        }
    }
}
