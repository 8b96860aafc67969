//! The odometry turns while the robot does not.

use reality_sim_core::pose::Motion2;

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct OdometryYawDrift;

const ABOUT: About = About {
    id: "odometry_yaw_drift",
    name: "the odometry turns by itself",
    stage: Stage::Odometry,
    parameters: &[Parameter::size("rad_per_s", "rad/s", [-0.3, 0.3], 0.002)],
    covariates: &[Covariate::Time],
    because: "the odometry's heading runs away evenly with time, whether the robot moves or stands",
    recording_that_would_decide: "record for a long time, standing still and walking",
};

impl Effect for OdometryYawDrift {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn odometry(&self, p: &[f64], motion: Motion2, duration_s: f64) -> Motion2 {
        let [rad_per_s] = values(p);
        Motion2 { turn_rad: motion.turn_rad + rad_per_s * duration_s, ..motion }
    }
}
