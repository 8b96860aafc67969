//! Time offset: the robot's clock differs from the clock of the reference poses.
//!
//! Images and odometry are taken this long after the time of the reference pose with the same timestamp.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct TimeOffset;

const ABOUT: About = About {
    id: "time_offset",
    name: "images and odometry are taken later than their time stamps say",
    because: "the whole picture is shifted in proportion to how fast the camera turns and moves, and the odometry with it",
    opposite: Some(Opposite {
        name: "images and odometry are taken earlier than their time stamps say",
        because: "the whole picture is shifted against how fast the camera turns and moves, and the odometry with it",
    }),
    noun: "a clock that is off",
    rank: 50,
    unit: Unit::Milliseconds,
    stage: Stage::Motion,
    parameters: &[Parameter::size("offset_s", "s", [-0.15, 0.15], 0.002)],
    covariates: &[Covariate::AngularRate, Covariate::Speed, Covariate::Frame],
    needs: &[],
    changes: Changes::PicturesAndOdometry,
    varies_over_time: false,
    recording_that_would_decide: "walk with quick turns of the head, with a reference pose for every picture",
};

impl Effect for TimeOffset {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(estimates.get("offset_s")?.in_unit(Unit::Milliseconds).with_direction(["late", "early"]))
    }

    fn clock_s(&self, p: &[f64]) -> f64 {
        let [offset_s] = values(p);
        offset_s
    }
}
