//! Clock jump: from one picture on, the pictures are taken later than their time stamps say, by one time.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Opposite, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct ClockJump;

const ABOUT: About = About {
    id: "clock_jump",
    name: "from one picture on, the pictures are taken later than their time stamps say",
    because: "from one time on, the whole picture is shifted in proportion to how fast the camera turns and moves",
    opposite: Some(Opposite {
        name: "from one picture on, the pictures are taken earlier than their time stamps say",
        because: "from one time on, the whole picture is shifted against how fast the camera turns and moves",
    }),
    noun: "a jump of the camera's clock",
    rank: 55,
    unit: Unit::Milliseconds,
    stage: Stage::Motion,
    parameters: &[Parameter::size("jump_s", "s", [-0.4, 0.4], 0.004), Parameter::fixed("at_s", "s")],
    covariates: &[Covariate::Time, Covariate::AngularRate, Covariate::Speed],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: true,
    recording_that_would_decide: "walk with quick turns of the head before and after the jump, with a reference pose for every picture",
};

impl Effect for ClockJump {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(estimates.get("jump_s")?.in_unit(Unit::Milliseconds).with_direction(["late", "early"]))
    }

    fn picture_delay_s(&self, p: &[f64], time_s: f64) -> f64 {
        let [jump_s, at_s] = values(p);
        if time_s >= at_s { jump_s } else { 0.0 }
    }
}
