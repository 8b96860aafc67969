//! Tangential distortion: the elements of the lens are not centred on one axis.
//!
//! p₁ and p₂ are added to those of `OPENCV` (Brown, "Decentering distortion of lenses", 1966); a pinhole becomes an `OPENCV`
//! camera. `OPENCV_FISHEYE` has no such terms. There the same formula shifts a point of the plane of unit focal length whose
//! radius is its angle from the optical axis, as in COLMAP's `THIN_PRISM_FISHEYE`.

use glam::{DVec2, DVec3};
use reality_sim_core::camera::{Camera, Distortion, InvalidCamera, Opencv};

use super::{adjustments::with_intrinsics, phrases::outstanding};
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::{Uncertain, Unit},
};

#[derive(Debug)]
pub(super) struct TangentialDistortion;

const ABOUT: About = About {
    id: "tangential_distortion",
    name: "the elements of the lens are not centred on one axis",
    because: "lines are shifted towards one side of the picture, more and more with the square of their distance from its centre",
    opposite: None,
    noun: "a lens that is off its axis",
    rank: 115,
    unit: Unit::Plain,
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("p1", "1", [-0.03, 0.03], 0.0003),
        Parameter::size("p2", "1", [-0.03, 0.03], 0.0003),
    ],
    covariates: &[Covariate::Pixel, Covariate::Radius],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "bring lines into all four corners of the picture as well as into its middle",
};

impl Effect for TangentialDistortion {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let coefficients = [("p1", estimates.get("p1")?), ("p2", estimates.get("p2")?)];
        let text = |(name, p): (&str, Uncertain)| {
            let p = p.in_unit(Unit::Plain);
            format!("{name} = {}{}", p.signed(), p.interval())
        };
        let texts: Vec<String> = outstanding(&coefficients).into_iter().map(text).collect();
        Some(texts.join(", "))
    }

    fn lens(&self, p: &[f64], camera: Camera) -> Result<Camera, InvalidCamera> {
        let [p1, p2] = values(p);
        let lens = match camera.distortion {
            Distortion::Opencv(lens) => lens,
            Distortion::Pinhole if (p1, p2) != (0.0, 0.0) => Opencv::default(),
            Distortion::Pinhole | Distortion::OpencvFisheye(_) => return Ok(camera),
        };
        let lens = Opencv { p1: lens.p1 + p1, p2: lens.p2 + p2, ..lens };
        let intrinsics = [camera.fx, camera.fy, camera.cx, camera.cy];
        with_intrinsics(&camera, intrinsics, Distortion::Opencv(lens))
    }

    fn shift_px(&self, p: &[f64], camera: &Camera, point_in_camera: DVec3) -> DVec2 {
        let [p1, p2] = values(p);
        if !matches!(camera.distortion, Distortion::OpencvFisheye(_)) {
            return DVec2::ZERO;
        }
        let across = point_in_camera.truncate();
        let place = across.normalize_or_zero() * across.length().atan2(point_in_camera.z);
        let (mixed, square) = (2.0 * place.x * place.y, place.length_squared());
        DVec2::new(
            camera.fx * (p1 * mixed + p2 * (square + 2.0 * place.x * place.x)),
            camera.fy * (p1 * (square + 2.0 * place.y * place.y) + p2 * mixed),
        )
    }
}
