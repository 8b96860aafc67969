//! The robot slips sideways as it walks ahead.
//!
//! `left += slip · forward`.

use reality_sim_core::pose::Motion2;

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct OdometryLateralSlip;

const ABOUT: About = About {
    id: "odometry_lateral_slip",
    name: "walking ahead, the odometry reports a sideways motion that was not",
    stage: Stage::Odometry,
    parameters: &[Parameter::size("m_per_m", "1", [-0.6, 0.6], 0.01)],
    covariates: &[Covariate::Speed],
    because: "the odometry's sideways steps differ from the true ones in proportion to the way ahead",
    recording_that_would_decide: "walk several metres straight ahead and back",
};

impl Effect for OdometryLateralSlip {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn odometry(&self, p: &[f64], motion: Motion2, _duration_s: f64) -> Motion2 {
        let [slip] = values(p);
        Motion2 { left_m: motion.left_m + slip * motion.forward_m, ..motion }
    }
}
