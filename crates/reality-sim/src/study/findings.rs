//! What a study says of a recording.

use std::collections::BTreeMap;

use reality_sim_core::sequence::{Origin, Sequence, SequenceError, read_origin};
use serde::Serialize;
use serde_json::Value;

/// Findings about a recording with some settings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Findings {
    /// What was studied.
    pub about: About,
    /// Numbers by name; names carry the unit. There are no times, which differ from run to run.
    pub figures: BTreeMap<String, f64>,
    /// Everything else.
    pub report: Value,
    /// Picture that says the most, as a small JPEG file, where there is one.
    #[serde(skip)]
    pub picture: Option<Vec<u8>>,
}

/// What a recording's files say of themselves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct About {
    /// Name of the recording.
    pub name: String,
    /// Name of the robot, if its files tell it.
    pub robot: Option<String>,
    /// Day of the recording as `2026-05-31`, if its files tell it.
    pub recorded_on: Option<String>,
    /// Time of the first picture by the recording's clock, seconds.
    pub begin_s: f64,
}

impl About {
    /// Reads what a recording's files say.
    pub(super) fn new(sequence: &Sequence) -> Result<Self, SequenceError> {
        let Origin { robot, recorded_on } = read_origin(&sequence.folder)?;
        let begin_s = sequence.frames.first().map_or(0.0, |frame| frame.timestamp_s);
        Ok(Self { name: sequence.name.clone(), robot, recorded_on, begin_s })
    }
}

impl Findings {
    /// Makes findings of figures, of which those that are unknown are left out, and a report.
    pub(super) fn new(
        about: About,
        figures: impl IntoIterator<Item = (String, Option<f64>)>,
        report: Value,
    ) -> Self {
        let known = figures.into_iter().filter_map(|(name, value)| Some((name, value?)));
        Self { about, figures: known.collect(), report, picture: None }
    }
}
