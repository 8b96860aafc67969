//! Rolling shutter: the sensor's rows are exposed one after another.
//!
//! `delay = readout · (row − ½) + reference`, where the row runs from 0 at the top to 1 at the bottom. The reference says
//! which row the timestamp belongs to: the middle row for 0, the first row for half the readout.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Parameter, Stage, values},
    text::Unit,
};

#[derive(Debug)]
pub(super) struct RollingShutter;

const ABOUT: About = About {
    id: "rolling_shutter",
    name: "the rows of a picture are exposed one after the other",
    because: "lines are shifted in proportion to their row and to how fast the camera turns",
    opposite: None,
    noun: "a rolling shutter",
    rank: 30,
    unit: Unit::Milliseconds,
    stage: Stage::Motion,
    parameters: &[
        Parameter::size("readout_s", "s", [-0.1, 0.1], 0.003),
        Parameter::shape("reference_s", "s", [-0.1, 0.1], 0.001),
    ],
    covariates: &[Covariate::Row, Covariate::AngularRate, Covariate::Speed],
    needs: &[],
    changes: Changes::Pictures,
    varies_over_time: false,
    recording_that_would_decide: "walk with quick turns of the head, with lines in the upper and lower part of the picture",
};

impl Effect for RollingShutter {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let readout = estimates.get("readout_s")?.in_unit(Unit::Milliseconds);
        let way = if readout.number.value < 0.0 {
            "from the bottom to the top"
        } else {
            "from the top to the bottom"
        };
        let stamp = row_of_time_stamp(estimates, readout.number.value)
            .map_or_else(String::new, |row| format!("; the time stamp is that of {row} row"));
        Some(format!("{way} within {}{}{stamp}", readout.size(), readout.interval()))
    }

    fn delay_s(&self, p: &[f64], row: f64) -> f64 {
        let [readout_s, reference_s] = values(p);
        readout_s * (row - 0.5) + reference_s
    }
}

/// Names the row without delay, if it is known.
fn row_of_time_stamp(estimates: &Estimates<'_>, readout_ms: f64) -> Option<&'static str> {
    let reference = estimates.get("reference_s").filter(|reference| reference.stands_out())?;
    let row = 0.5 - 1e3 * reference.value / readout_ms;
    let fifth = (5.0 * row).clamp(0.0, 4.0) as usize;
    let is_near = readout_ms != 0.0 && (-0.1..=1.1).contains(&row);
    is_near.then(|| ["the top", "an upper", "the middle", "a lower", "the bottom"][fifth])
}
