//! Odometry scale: the odometry reports longer or shorter steps than the robot makes.
//!
//! The reported `forward` and `left` are the true ones times `1 + scale`.

use reality_sim_core::pose::Motion2;

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct OdometryScale;

const ABOUT: About = About {
    id: "odometry_scale",
    name: "the odometry reports longer or shorter ways than were walked",
    because: "the odometry's steps differ from the true ones in proportion to their length",
    opposite: None,
    noun: "an odometry of another scale",
    rank: 200,
    unit: Unit::Percent,
    stage: Stage::Odometry,
    parameters: &[Parameter::size("scale", "1", [-0.6, 0.6], 0.01)],
    covariates: &[Covariate::Speed],
    needs: &[Need::Odometry],
    changes: Changes::Odometry,
    varies_over_time: false,
    recording_that_would_decide: "walk several metres straight ahead and sideways",
};

impl Effect for OdometryScale {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        Some(estimates.get("scale")?.in_unit(Unit::Percent).with_direction(["too long", "too short"]))
    }

    fn odometry(&self, p: &[f64], motion: Motion2, _duration_s: f64) -> Motion2 {
        let [scale] = values(p);
        let factor = 1.0 + scale;
        Motion2 { forward_m: factor * motion.forward_m, left_m: factor * motion.left_m, ..motion }
    }
}
