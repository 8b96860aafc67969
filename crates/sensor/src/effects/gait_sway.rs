//! Gait sway: the camera nods and bobs with the robot's steps in a way that its reference poses do not show.
//!
//! Pitch and height change by `cos` and `sin` of the gait's phase `2π f t`.

use std::f64::consts::TAU;

use reality_sim_core::pose::CameraPose;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::{Uncertain, Unit},
};

#[derive(Debug)]
pub(super) struct GaitSway;

const ABOUT: About = About {
    id: "gait_sway",
    name: "the camera sways with the steps more than its reference poses do",
    because: "lines move up and down from picture to picture in time with the robot's steps",
    opposite: None,
    noun: "a sway with the steps",
    rank: 57,
    unit: Unit::Degrees,
    stage: Stage::Motion,
    parameters: &[
        Parameter::size("pitch_cos_rad", "rad", [-0.1, 0.1], 0.002),
        Parameter::size("pitch_sin_rad", "rad", [-0.1, 0.1], 0.002),
        Parameter::shape("height_cos_m", "m", [-0.05, 0.05], 0.001),
        Parameter::shape("height_sin_m", "m", [-0.05, 0.05], 0.001),
        Parameter::fixed("gait_hz", "Hz"),
    ],
    covariates: &[Covariate::GaitPhase, Covariate::Frame],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: true,
    recording_that_would_decide: "walk straight ahead for a long time, past lines near and far, and stand still in between",
};

impl Effect for GaitSway {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let (cos, sin) = (estimates.get("pitch_cos_rad")?, estimates.get("pitch_sin_rad")?);
        let value = cos.value.hypot(sin.value);
        let sigma = (cos.value * cos.sigma).hypot(sin.value * sin.sigma) / value.max(f64::MIN_POSITIVE);
        let amplitude = Uncertain { value, sigma }.in_unit(Unit::Degrees);
        Some(format!("it nods by {} up and down{}", amplitude.size(), amplitude.interval()))
    }

    fn sway(&self, p: &[f64], pose: CameraPose, time_s: f64) -> CameraPose {
        let [pitch_cos_rad, pitch_sin_rad, height_cos_m, height_sin_m, gait_hz] = values(p);
        let (sin, cos) = (TAU * gait_hz * time_s).sin_cos();
        CameraPose {
            pitch_rad: pose.pitch_rad + pitch_cos_rad * cos + pitch_sin_rad * sin,
            height_m: pose.height_m + height_cos_m * cos + height_sin_m * sin,
            ..pose
        }
    }
}
