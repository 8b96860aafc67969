//! Studies of recordings.

use std::path::{MAIN_SEPARATOR, Path, PathBuf};

use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::study::{Findings, StudyError, StudySettings, study as study_with};
use serde_json::json;

use crate::{
    error::{failed, with_causes},
    interruptible::interruptible,
};

/// Completes the settings of a study, in JSON, by the default values.
#[pyfunction]
pub fn study_settings(settings: &str) -> PyResult<String> {
    let settings = parsed(settings)?;
    serde_json::to_string(&settings).map_err(failed)
}

/// Studies a recording with each of some settings, in JSON. Returns for each what was found, or the error and whether it is the machine's, in
/// JSON, with a JPEG file.
#[pyfunction]
pub fn study(
    py: Python<'_>,
    recording: PathBuf,
    settings: Vec<String>,
) -> PyResult<Vec<(String, Option<Vec<u8>>)>> {
    let settings = settings.iter().map(|settings| parsed(settings)).collect::<PyResult<Vec<_>>>()?;
    let folder = recording.clone();
    let found = interruptible(py, move || study_with(&folder, &settings))?;
    found.into_iter().map(|found| told(found, &recording)).collect()
}

/// Returns findings, or the error, in JSON, and their picture.
fn told(found: Result<Findings, StudyError>, recording: &Path) -> PyResult<(String, Option<Vec<u8>>)> {
    match found {
        Ok(findings) => Ok((serde_json::to_string(&findings).map_err(failed)?, findings.picture)),
        Err(error) => {
            let message = within(&with_causes(&error), recording);
            Ok((json!({ "error": message, "is_of_machine": error.is_of_machine() }).to_string(), None))
        }
    }
}

/// Names the files of a recording as they are named in it: a message is the same wherever the recording lies.
fn within(message: &str, recording: &Path) -> String {
    let folder = recording.display().to_string();
    message.replace(&format!("{folder}{MAIN_SEPARATOR}"), "").replace(&format!("{folder}:"), "the recording:")
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
