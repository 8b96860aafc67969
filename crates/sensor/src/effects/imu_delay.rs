//! IMU delay: pitch and roll as the robot states them are late against the pictures.
//!
//! The pitch and roll with a timestamp are those of the camera at a time this much earlier.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct ImuDelay;

const ABOUT: About = About {
    id: "imu_delay",
    name: "pitch and roll by joints and IMU are late against the pictures",
    because: "pitch and roll in frames.csv differ from those of the reference poses in proportion to how fast the camera nods and rolls",
    opposite: Some(Opposite {
        name: "pitch and roll by joints and IMU are ahead of the pictures",
        because: "pitch and roll in frames.csv differ from those of the reference poses against how fast the camera nods and rolls",
    }),
    noun: "a late IMU",
    rank: 240,
    unit: Unit::Milliseconds,
    stage: Stage::Odometry,
    parameters: &[Parameter::size("delay_s", "s", [-0.3, 0.3], 0.005)],
    covariates: &[Covariate::AngularRate],
    needs: &[Need::MeasuredPoses],
    changes: Changes::Attitude,
    varies_over_time: false,
    recording_that_would_decide: "walk fast or nod and roll the head quickly, with a measured pose for every picture",
};

impl Effect for ImuDelay {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(estimates.get("delay_s")?.in_unit(Unit::Milliseconds).with_direction(["late", "early"]))
    }

    fn attitude_delay_s(&self, p: &[f64]) -> f64 {
        let [delay_s] = values(p);
        delay_s
    }
}
