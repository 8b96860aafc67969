//! Principal point: the optical axis meets the sensor away from the calibrated pixel.

use reality_sim_core::camera::{Camera, InvalidCamera};

use super::{adjustments::with_intrinsics, phrases::outstanding};
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct PrincipalPoint;

const ABOUT: About = About {
    id: "principal_point",
    name: "the optical axis meets the sensor beside the calibrated pixel",
    because: "every picture is shifted as a whole by the same number of pixels",
    opposite: None,
    noun: "a shifted picture",
    rank: 130,
    unit: Unit::Pixels,
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("x_px", "px", [-30.0, 30.0], 0.3),
        Parameter::size("y_px", "px", [-30.0, 30.0], 0.3),
    ],
    covariates: &[Covariate::Pixel],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "look at lines with the head rolled to both sides and lowered, so that the shift cannot be a turn of the mount",
};

impl Effect for PrincipalPoint {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let shifts = [
            (["farther right", "farther left"], estimates.get("x_px")?),
            (["lower", "higher"], estimates.get("y_px")?),
        ];
        let texts: Vec<String> = outstanding(&shifts)
            .into_iter()
            .map(|(words, shift)| shift.in_unit(Unit::Pixels).with_direction(words))
            .collect();
        Some(format!("the picture's centre is {}", texts.join(" and ")))
    }

    fn lens(&self, p: &[f64], camera: Camera) -> Result<Camera, InvalidCamera> {
        let [x_px, y_px] = values(p);
        let intrinsics = [camera.fx, camera.fy, camera.cx + x_px, camera.cy + y_px];
        with_intrinsics(&camera, intrinsics, camera.distortion)
    }
}
