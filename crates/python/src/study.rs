//! Studies of recordings.

use std::path::PathBuf;

use pyo3::{
    exceptions::{PyOSError, PyValueError},
    prelude::*,
};
use reality_sim::study::{Findings, StudyError, StudySettings, study as study_with};
use serde_json::json;

use crate::error::{failed, with_causes};

/// Completes the settings of a study, in JSON, by the default values.
#[pyfunction]
pub fn study_settings(settings: &str) -> PyResult<String> {
    let settings = parsed(settings)?;
    serde_json::to_string(&settings).map_err(failed)
}

/// Studies a recording with each of some settings, in JSON; data sets made from it are in a folder of its `name`. Returns for each what was found, or the error, in JSON, with a JPEG file; raises an error of the
/// machine, which says nothing of the recording.
#[pyfunction]
pub fn study(
    py: Python<'_>,
    recording: PathBuf,
    name: &str,
    settings: Vec<String>,
) -> PyResult<Vec<(String, Option<Vec<u8>>)>> {
    let settings = settings.iter().map(|settings| parsed(settings)).collect::<PyResult<Vec<_>>>()?;
    let found = py.detach(|| study_with(&recording, name, &settings));
    if let Some(error) =
        found.iter().filter_map(|found| found.as_ref().err()).find(|error| error.is_of_machine())
    {
        return Err(PyOSError::new_err(with_causes(error)));
    }
    found.into_iter().map(told).collect()
}

/// Returns findings, or the error, in JSON, and their picture.
fn told(found: Result<Findings, StudyError>) -> PyResult<(String, Option<Vec<u8>>)> {
    match found {
        Ok(findings) => Ok((serde_json::to_string(&findings).map_err(failed)?, findings.picture)),
        Err(error) => Ok((json!({ "error": with_causes(&error) }).to_string(), None)),
    }
}

/// Sets how many threads work at once. Returns false if another number was set, or used, before.
#[pyfunction]
pub fn use_threads(threads: usize) -> bool {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    builder.build_global().is_ok() || rayon::current_num_threads() == threads
}

fn parsed(settings: &str) -> PyResult<StudySettings> {
    serde_json::from_str(settings).map_err(|error| PyValueError::new_err(format!("settings: {error}")))
}
