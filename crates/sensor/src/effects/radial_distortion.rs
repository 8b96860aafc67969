//! Radial distortion: the lens bends straight lines more or less than its calibration says.
//!
//! The coefficients are added to those of the lens model: k₁ … k₄ of `OPENCV_FISHEYE` (Kannala and Brandt, "A generic
//! camera model", PAMI 2006), k₁ … k₃ of `OPENCV` (Brown and Conrady: Brown, "Close-range camera calibration", 1971). A
//! pinhole becomes an `OPENCV` camera.

use reality_sim_core::camera::{Camera, Distortion, InvalidCamera, Opencv, OpencvFisheye};

use super::{adjustments::with_intrinsics, phrases::outstanding};
use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::{Uncertain, Unit},
};

#[derive(Debug)]
pub(super) struct RadialDistortion;

const ABOUT: About = About {
    id: "radial_distortion",
    name: "the lens bends straight lines other than calibrated",
    because: "lines are shifted towards the image centre or away from it, more and more towards the corners",
    opposite: None,
    noun: "a bent picture",
    rank: 40,
    unit: Unit::Plain,
    stage: Stage::Lens,
    parameters: &[
        Parameter::size("k1", "1", [-0.15, 0.15], 0.001),
        Parameter::size("k2", "1", [-0.06, 0.06], 0.0005),
        Parameter::size("k3", "1", [-0.02, 0.02], 0.0002),
        Parameter::size("k4", "1", [-0.005, 0.005], 0.0001),
    ],
    covariates: &[Covariate::Radius],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "bring lines into the corners of the picture as well as into its middle",
};

impl Effect for RadialDistortion {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let coefficients: Vec<(&str, Uncertain)> = ["k1", "k2", "k3", "k4"]
            .into_iter()
            .filter_map(|name| Some((name, estimates.get(name)?)))
            .collect();
        let text = |(name, k): (&str, Uncertain)| {
            let k = k.in_unit(Unit::Plain);
            format!("{name} = {}{}", k.signed(), k.interval())
        };
        let texts: Vec<String> = outstanding(&coefficients).into_iter().map(text).collect();
        (!texts.is_empty()).then(|| format!("{}{}", texts.join(", "), direction(&coefficients)))
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

/// The fourth coefficient has no counterpart in Brown's model.
fn bent(lens: Opencv, [k1, k2, k3, _]: [f64; 4]) -> Opencv {
    Opencv { k1: lens.k1 + k1, k2: lens.k2 + k2, k3: lens.k3 + k3, ..lens }
}

/// Names the direction in which points move, where it is the same near the centre and far from it. For small changes of
/// either lens model, points move by `k₁r³ + k₂r⁵ + …` in units of the focal length.
fn direction(coefficients: &[(&str, Uncertain)]) -> &'static str {
    let shift = |radius: f64| {
        let terms = coefficients.iter().zip([3, 5, 7, 9]).map(|((_, k), power)| k.value * radius.powi(power));
        terms.sum::<f64>()
    };
    match [0.4, 0.6, 0.8, 1.0].map(shift) {
        shifts if shifts.iter().all(|shift| *shift > 0.0) => {
            ", which moves points far from the middle outwards"
        }
        shifts if shifts.iter().all(|shift| *shift < 0.0) => {
            ", which moves points far from the middle inwards"
        }
        _ => "",
    }
}
