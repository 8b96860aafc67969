//! The optical axis meets the sensor beside the calibrated pixel.

use reality_sim_core::camera::{Camera, InvalidCamera};

use super::adjustments::with_intrinsics;
use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct PrincipalPoint;

const ABOUT: About = About {
    id: "principal_point",
    name: "the optical axis meets the sensor beside the calibrated pixel",
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("x_px", "px", [-30.0, 30.0], 0.3),
        Parameter::size("y_px", "px", [-30.0, 30.0], 0.3),
    ],
    covariates: &[Covariate::Pixel],
    because: "every picture is shifted as a whole by the same number of pixels",
    recording_that_would_decide: "look at lines with the head rolled to both sides and lowered, so that the shift cannot be a turn of the mount",
};

impl Effect for PrincipalPoint {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn lens(&self, p: &[f64], camera: Camera) -> Result<Camera, InvalidCamera> {
        let [x_px, y_px] = values(p);
        let intrinsics = [camera.fx, camera.fy, camera.cx + x_px, camera.cy + y_px];
        with_intrinsics(&camera, intrinsics, camera.distortion)
    }
}
