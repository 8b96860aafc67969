//! Lateral slip: the robot slips sideways as it walks forwards.
//!
//! `left += slip · forward`.

use reality_sim_core::pose::Motion2;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct OdometryLateralSlip;

const ABOUT: About = About {
    id: "odometry_lateral_slip",
    name: "walking ahead, the odometry reports a sideways motion that was not",
    because: "the odometry's sideways steps differ from the true ones in proportion to the way ahead",
    opposite: None,
    noun: "a slipping odometry",
    rank: 220,
    unit: Unit::Percent,
    stage: Stage::Odometry,
    parameters: &[Parameter::size("m_per_m", "1", [-0.6, 0.6], 0.01)],
    covariates: &[Covariate::Speed],
    needs: &[Need::Odometry],
    changes: Changes::Odometry,
    varies_over_time: false,
    recording_that_would_decide: "walk several metres straight ahead and back",
};

impl Effect for OdometryLateralSlip {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let slip = estimates.get("m_per_m")?.in_unit(Unit::Centimeters);
        let text = slip.with_direction(["to the left", "to the right"]);
        Some(format!("for each metre ahead the odometry reports another {text}"))
    }

    fn odometry(&self, p: &[f64], motion: Motion2, _duration_s: f64) -> Motion2 {
        let [slip] = values(p);
        Motion2 { left_m: motion.left_m + slip * motion.forward_m, ..motion }
    }
}
