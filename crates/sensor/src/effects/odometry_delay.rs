//! Odometry delay: the odometry is late against the pictures.
//!
//! A motion that the odometry reports between two timestamps is that between times this much earlier.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct OdometryDelay;

const ABOUT: About = About {
    id: "odometry_delay",
    name: "the odometry is late against the pictures",
    because: "the odometry reports a motion after the pictures show it, whenever the robot starts, stops or turns",
    opposite: Some(Opposite {
        name: "the odometry is ahead of the pictures",
        because: "the odometry reports a motion before the pictures show it, whenever the robot starts, stops or turns",
    }),
    noun: "a late odometry",
    rank: 230,
    unit: Unit::Milliseconds,
    stage: Stage::Odometry,
    parameters: &[Parameter::size("delay_s", "s", [-0.3, 0.3], 0.01)],
    covariates: &[Covariate::Speed, Covariate::AngularRate],
    needs: &[Need::Odometry],
    changes: Changes::Odometry,
    varies_over_time: false,
    recording_that_would_decide: "start, stop and turn quickly, again and again",
};

impl Effect for OdometryDelay {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(estimates.get("delay_s")?.in_unit(Unit::Milliseconds).with_direction(["late", "early"]))
    }

    fn odometry_delay_s(&self, p: &[f64]) -> f64 {
        let [delay_s] = values(p);
        delay_s
    }
}
