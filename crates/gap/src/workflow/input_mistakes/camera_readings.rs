//! Readings of the camera file: with another focal length, or made for pictures of another size.

use reality_sim_core::camera::Camera;

use crate::{
    diagnostics::input_mistake::InputMistake,
    thresholds::{InputMistakeThresholds, Thresholds},
};

const THRESHOLDS: InputMistakeThresholds = Thresholds::DEFAULT.workflow.input_mistake;

/// Returns the ways in which a camera file may be wrong by a factor, with the camera that was meant.
pub(super) fn cameras(camera: &Camera) -> Vec<(InputMistake, Camera)> {
    let [least, most] = THRESHOLDS.camera_factors;
    let steps = ((most / least).ln() / THRESHOLDS.camera_step.ln()).round() as i32;
    let factors = (0..=steps).map(|step| least * THRESHOLDS.camera_step.powi(step));
    factors.flat_map(|factor| [factor, 1.0 / factor]).flat_map(|factor| read(camera, factor)).collect()
}

/// Returns the readings close to the best one, which was found in steps.
pub(super) fn near(camera: &Camera, best: InputMistake) -> Vec<(InputMistake, Camera)> {
    let (InputMistake::FocalLength { percent } | InputMistake::CameraOfOtherSize { percent }) = best else {
        return Vec::new();
    };
    let kind = std::mem::discriminant(&best);
    let factors = (-3..=3).map(|step| f64::from(step).mul_add(0.01, 1.0) * 100.0 / f64::from(percent));
    let readings = factors.flat_map(|factor| read(camera, factor));
    readings.filter(|(mistake, _)| std::mem::discriminant(mistake) == kind).collect()
}

/// Returns the camera whose focal lengths, or all of whose pixels, are this many times those of the file.
fn read(camera: &Camera, factor: f64) -> [(InputMistake, Camera); 2] {
    let percent = (100.0 / factor).round() as u32;
    let mut focal = camera.clone();
    focal.fx *= factor;
    focal.fy *= factor;
    let mut size = focal.clone();
    size.cx *= factor;
    size.cy *= factor;
    [(InputMistake::FocalLength { percent }, focal), (InputMistake::CameraOfOtherSize { percent }, size)]
}
