//! `gap --inject`: a control on the user's own recording.

use anyhow::Context;
use reality_sim::{
    gap::{
        Analysis, MeasureError, Options, Recording, ReferenceSource, inject, injected_parameter,
        report::{Report, text::effect_size},
    },
    sensor::{Effect, effect, library},
    sequence::write_atomically,
};
use serde::Serialize;

use super::GapArgs;
use crate::commands::{output::aligned, output_folder::OutputFolder};

/// Multiples of the detection limit at which an effect is hidden, until it is named.
const MULTIPLES: [f64; 3] = [1.0, 2.0, 4.0];

/// Effect that was hidden.
#[derive(Debug, Clone, Serialize)]
pub struct Hidden {
    id: &'static str,
    parameter: &'static str,
    value: f64,
    unit: &'static str,
}

/// Report on a recording in which an effect was hidden.
#[derive(Serialize)]
pub struct ControlReport<'a> {
    #[serde(flatten)]
    report: &'a Report,
    injected: &'a Hidden,
    named: bool,
}

impl<'a> ControlReport<'a> {
    pub fn new(report: &'a Report, injected: &'a Hidden) -> Self {
        Self { named: names(report, injected.id), report, injected }
    }

    /// Returns whether the hidden effect was named, in a sentence.
    pub fn sentence(&self) -> String {
        let Hidden { id, parameter, value, unit } = self.injected;
        let unit = if *unit == "1" { String::new() } else { format!(" {unit}") };
        let hidden = format!("Hidden as a control: {id} with {parameter} = {value}{unit}.");
        match self.report.effects.iter().find(|found| found.id == *id) {
            Some(found) => format!("{hidden} It was named: {}.", effect_size(found)),
            None => format!("{hidden} It was not named."),
        }
    }
}

fn names(report: &Report, id: &str) -> bool {
    report.effects.iter().any(|found| found.id == id)
}

/// Recording to which controls are applied.
pub struct Controls<'a> {
    pub recording: &'a Recording<'a>,
    pub source: ReferenceSource,
    pub args: &'a GapArgs,
    pub options: &'a Options,
}

impl Controls<'_> {
    /// Hides an effect and passes the recording on.
    pub fn with_hidden<T>(
        &self,
        id: &str,
        size: f64,
        use_recording: impl FnOnce(&Recording<'_>, Hidden) -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let known = effect(id).with_context(|| format!("there is no effect {id}"))?;
        let changed = inject(self.recording, known, size)?;
        let poses: Vec<_> = changed.sequence.reference_poses().collect();
        let recording = Recording::new(
            &changed.sequence,
            &poses,
            self.source,
            self.args.frames_among(changed.sequence.frames.len()),
        )?;
        use_recording(&recording, hidden(known, size))
    }

    /// Hides every effect in turn. `plain` is the report on the recording as it is.
    pub fn all(
        &self,
        plain: &Report,
        analyse: impl Fn(&Recording<'_>) -> Result<Analysis, MeasureError>,
    ) -> anyhow::Result<Vec<Row>> {
        let effects =
            library().iter().filter(|effect| !self.options.without.iter().any(|id| id == effect.id()));
        effects.map(|effect| self.row(*effect, plain, &analyse)).collect()
    }

    fn row(
        &self,
        effect: &'static dyn Effect,
        plain: &Report,
        analyse: &impl Fn(&Recording<'_>) -> Result<Analysis, MeasureError>,
    ) -> anyhow::Result<Row> {
        let mut row = Row { id: effect.id(), unit: "", predicted: None, named_from: None, reason: None };
        let Some(limit) = plain.not_found.iter().find(|other| other.id == effect.id()) else {
            let is_there =
                names(plain, effect.id()) || plain.in_model.iter().any(|other| other.id == effect.id());
            row.reason = Some(if is_there { "is there already" } else { "cannot be seen" }.to_owned());
            return Ok(row);
        };
        row.predicted = Some(limit.detection_limit.value);
        let Some(parameter) = injected_parameter(effect).filter(|one| one.name == limit.parameter) else {
            row.reason =
                Some(format!("its limit is one of {}, which cannot be hidden alone", limit.parameter));
            return Ok(row);
        };
        row.unit = parameter.unit;
        for multiple in MULTIPLES {
            let size = parameter.neutral + multiple * limit.detection_limit.value;
            let size = if size > parameter.range[1] { 2.0 * parameter.neutral - size } else { size };
            if size < parameter.range[0] {
                break;
            }
            let named = self.with_hidden(effect.id(), size, |recording, hidden| {
                Ok(names(&analyse(recording)?.report, hidden.id))
            });
            match named {
                Ok(false) => {}
                Ok(true) => {
                    row.named_from = Some(multiple * limit.detection_limit.value);
                    return Ok(row);
                }
                Err(error) => {
                    row.reason = Some(error.to_string());
                    return Ok(row);
                }
            }
        }
        row.reason = Some("was not named".to_owned());
        Ok(row)
    }
}

fn hidden(effect: &'static dyn Effect, value: f64) -> Hidden {
    let (parameter, unit) = injected_parameter(effect).map_or(("", "1"), |one| (one.name, one.unit));
    Hidden { id: effect.id(), parameter, value, unit }
}

/// Controls with one effect.
#[derive(Debug, Serialize)]
pub struct Row {
    id: &'static str,
    unit: &'static str,
    /// Detection limit by simulation.
    predicted: Option<f64>,
    /// Smallest size that was tried and named.
    named_from: Option<f64>,
    /// Why nothing was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

/// Writes the controls beside the report.
pub fn write(folder: &OutputFolder, rows: &[Row]) -> anyhow::Result<()> {
    write_atomically(&folder.file("controls.json")?, serde_json::to_string_pretty(rows)?.as_bytes())?;
    Ok(())
}

/// Returns the controls as lines.
pub fn table(rows: &[Row]) -> String {
    let line = |row: &Row| {
        let unit =
            if row.unit == "1" || row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
        let size = |value: f64| format!("{value:.2e}{unit}");
        let text = match (row.predicted, row.named_from, &row.reason) {
            (Some(limit), Some(named), _) => format!("limit {}, named from {}", size(limit), size(named)),
            (Some(limit), None, Some(reason)) => format!("limit {}: {reason}", size(limit)),
            (_, _, reason) => reason.clone().unwrap_or_default(),
        };
        (row.id, text)
    };
    aligned(&rows.iter().map(line).collect::<Vec<_>>())
}
