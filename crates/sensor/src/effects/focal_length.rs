//! Focal length: the lens magnifies more or less than its calibration says.

use reality_sim_core::camera::{Camera, InvalidCamera};

use super::adjustments::with_intrinsics;
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct FocalLength;

const ABOUT: About = About {
    id: "focal_length",
    name: "the picture is magnified more than calibrated",
    because: "lines are shifted away from the image centre in proportion to their distance from it",
    opposite: Some(Opposite {
        name: "the picture is magnified less than calibrated",
        because: "lines are shifted towards the image centre in proportion to their distance from it",
    }),
    noun: "another magnification",
    rank: 110,
    unit: Unit::Percent,
    stage: Stage::Lens,
    parameters: &[Parameter::size("scale", "1", [-0.2, 0.2], 0.001)],
    covariates: &[Covariate::Radius],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "bring lines into every part of the picture, near and far ones",
};

impl Effect for FocalLength {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let words = ["larger than calibrated", "smaller than calibrated"];
        Some(estimates.get("scale")?.in_unit(Unit::Percent).with_direction(words))
    }

    fn lens(&self, p: &[f64], camera: Camera) -> Result<Camera, InvalidCamera> {
        let [scale] = values(p);
        let factor = 1.0 + scale;
        let intrinsics = [factor * camera.fx, factor * camera.fy, camera.cx, camera.cy];
        with_intrinsics(&camera, intrinsics, camera.distortion)
    }
}
