//! Yaw drift: the odometry reports a turn while the robot does not turn.
//!
//! `turn += rate · duration`.

use reality_sim_core::pose::Motion2;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct OdometryYawDrift;

const ABOUT: About = About {
    id: "odometry_yaw_drift",
    name: "the odometry turns by itself",
    because: "the odometry's heading runs away evenly with time, whether the robot moves or stands",
    opposite: None,
    noun: "a turning odometry",
    rank: 210,
    unit: Unit::DegreesPerSecond,
    stage: Stage::Odometry,
    parameters: &[Parameter::size("rad_per_s", "rad/s", [-0.3, 0.3], 0.002)],
    covariates: &[Covariate::Time],
    needs: &[Need::Odometry],
    changes: Changes::Odometry,
    varies_over_time: false,
    recording_that_would_decide: "record for a long time, standing still and walking",
};

impl Effect for OdometryYawDrift {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let rate = estimates.get("rad_per_s")?.in_unit(Unit::DegreesPerSecond);
        Some(rate.with_direction(["to the left", "to the right"]))
    }

    fn odometry(&self, p: &[f64], motion: Motion2, duration_s: f64) -> Motion2 {
        let [rad_per_s] = values(p);
        Motion2 { turn_rad: motion.turn_rad + rad_per_s * duration_s, ..motion }
    }
}
