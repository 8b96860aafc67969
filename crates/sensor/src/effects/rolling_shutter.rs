//! The sensor's rows are read one after the other.
//!
//! `delay = readout · (row − ½) + reference`, with the row from 0, the top one, to 1. The reference says which row the
//! time stamp belongs to: 0 is the middle one, half the readout the first.

use crate::effect::{About, Covariate, Effect, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct RollingShutter;

const ABOUT: About = About {
    id: "rolling_shutter",
    name: "the rows of a picture are exposed one after the other",
    stage: Stage::Motion,
    parameters: &[
        Parameter::size("readout_s", "s", [-0.1, 0.1], 0.003),
        Parameter::shape("reference_s", "s", [-0.1, 0.1], 0.001),
    ],
    covariates: &[Covariate::Row, Covariate::AngularRate, Covariate::Speed],
    because: "lines are shifted in proportion to their row and to how fast the camera turns",
    recording_that_would_decide: "walk with quick turns of the head, with lines in the upper and lower part of the picture",
};

impl Effect for RollingShutter {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn delay_s(&self, p: &[f64], row: f64) -> f64 {
        let [readout_s, reference_s] = values(p);
        readout_s * (row - 0.5) + reference_s
    }
}
