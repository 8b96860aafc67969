//! Comparison of recordings with models of their cameras.

use std::path::PathBuf;

use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::{
    Sequence,
    comparison::{ComparisonSettings, compare},
};

use crate::{error::failed, interruptible::interruptible};

/// Compares a recording with a model of its camera, with settings in JSON. Returns report.json, model.toml and report.html.
#[pyfunction]
pub fn gap(py: Python<'_>, recording: PathBuf, settings: &str) -> PyResult<(String, String, String)> {
    let settings: ComparisonSettings = serde_json::from_str(settings)
        .map_err(|error| PyValueError::new_err(format!("settings: {error}")))?;
    interruptible(py, move || {
        let sequence = Sequence::open(&recording).map_err(failed)?;
        let comparison = compare(&sequence, &settings).map_err(failed)?;
        let page = comparison.page(&sequence).map_err(failed)?;
        let report = serde_json::to_string(&comparison.analysis.report).map_err(failed)?;
        Ok((report, comparison.analysis.model.to_toml(), page))
    })?
}
