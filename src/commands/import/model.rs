//! Models of other programs, and tables with a mapping, as sequences.

use std::path::Path;

use anyhow::bail;
use serde::Serialize;

use reality_sim::sequence::counted;
use reality_sim_formats::{
    Input, ModelImport, ModelImportReport, colmap::read_colmap_as_sequence,
    mapped_table::read_table_as_sequence, nerfstudio::read_nerfstudio_as_sequence,
};

use crate::commands::output::aligned;

/// Report of a model, with the keys that the report of a log has.
#[derive(Debug, Serialize)]
pub struct ModelReport {
    sequence: String,
    pub frames: usize,
    unmatched: usize,
    salvaged: bool,
    clock_jumps: usize,
    has_times: bool,
    warnings: Vec<String>,
}

/// Makes a sequence of a model or of a table. `options` are of models alone: a table's mapping has its own.
pub fn import_model(
    kind: Input,
    input: &Path,
    out: &Path,
    options: impl FnOnce() -> anyhow::Result<ModelImport>,
) -> anyhow::Result<ModelReport> {
    let read = match kind {
        Input::ColmapModel => read_colmap_as_sequence(input, out, &options()?)?,
        Input::Nerfstudio => read_nerfstudio_as_sequence(input, out, &options()?)?,
        Input::Table => ModelImportReport {
            frames: read_table_as_sequence(input, out)?,
            has_times: true,
            warnings: Vec::new(),
        },
        Input::Sequence | Input::Log => bail!("{}: is no model of another program", input.display()),
    };
    Ok(ModelReport {
        sequence: out.display().to_string(),
        frames: read.frames,
        unmatched: 0,
        salvaged: false,
        clock_jumps: 0,
        has_times: read.has_times,
        warnings: read.warnings,
    })
}

impl ModelReport {
    /// Formats the report for people.
    pub fn text(&self) -> String {
        let mut lines = vec![("frames", counted(self.frames, "frame"))];
        if !self.has_times {
            lines.push(("times", "the model has none: they follow from --rate-hz".to_owned()));
        }
        lines.extend(self.warnings.iter().map(|warning| ("warning", warning.clone())));
        lines.push(("sequence", self.sequence.clone()));
        aligned(&lines)
    }
}
