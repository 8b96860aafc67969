//! The lens bends straight lines more or less than its calibration says.
//!
//! The numbers are added to those of the lens model: k₁ … k₄ of `OPENCV_FISHEYE`, k₁ … k₃ of `OPENCV`. A pinhole becomes
//! an `OPENCV` camera.

use reality_sim_core::camera::{Camera, Distortion, InvalidCamera, Opencv, OpencvFisheye};

use super::adjustments::with_intrinsics;
use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct RadialDistortion;

const ABOUT: About = About {
    id: "radial_distortion",
    name: "the lens bends straight lines other than calibrated",
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("k1", "1", [-0.15, 0.15], 0.001),
        Parameter::size("k2", "1", [-0.06, 0.06], 0.0005),
        Parameter::size("k3", "1", [-0.02, 0.02], 0.0002),
        Parameter::size("k4", "1", [-0.005, 0.005], 0.0001),
    ],
    covariates: &[Covariate::Radius],
    because: "lines are shifted towards the image centre or away from it, more and more towards the corners",
    recording_that_would_decide: "bring lines into the corners of the picture as well as into its middle",
};

impl Effect for RadialDistortion {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn lens(&self, p: &[f64], camera: Camera) -> Result<Camera, InvalidCamera> {
        let change: [f64; 4] = values(p);
        if change == [0.0; 4] {
            return Ok(camera);
        }
        let distortion = match camera.distortion {
            Distortion::OpencvFisheye(lens) => {
                let k = std::array::from_fn(|index| lens.k[index] + change[index]);
                Distortion::OpencvFisheye(OpencvFisheye { k })
            }
            Distortion::Opencv(lens) => Distortion::Opencv(bent(lens, change)),
            Distortion::Pinhole => Distortion::Opencv(bent(Opencv::default(), change)),
        };
        with_intrinsics(&camera, [camera.fx, camera.fy, camera.cx, camera.cy], distortion)
    }
}

/// The fourth has no counterpart in Brown's model.
fn bent(lens: Opencv, [k1, k2, k3, _]: [f64; 4]) -> Opencv {
    Opencv { k1: lens.k1 + k1, k2: lens.k2 + k2, k3: lens.k3 + k3, ..lens }
}
