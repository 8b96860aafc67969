//! The robot walks farther than its odometry says.

use reality_sim_core::pose::Motion2;

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct OdometryScale;

const ABOUT: About = About {
    id: "odometry_scale",
    name: "the odometry reports longer or shorter ways than were walked",
    stage: Stage::Odometry,
    parameters: &[Parameter::size("scale", "1", [-0.6, 0.6], 0.01)],
    covariates: &[Covariate::Speed],
    because: "the odometry's steps differ from the true ones in proportion to their length",
    recording_that_would_decide: "walk several metres straight ahead and sideways",
};

impl Effect for OdometryScale {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn odometry(&self, p: &[f64], motion: Motion2, _duration_s: f64) -> Motion2 {
        let [scale] = values(p);
        let factor = 1.0 + scale;
        Motion2 { forward_m: factor * motion.forward_m, left_m: factor * motion.left_m, ..motion }
    }
}
