//! Data sets: pictures at random poses with labels.

use std::path::PathBuf;

use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::dataset::{DatasetSettings, DatasetSource, make};

use crate::{database::Database, error::failed, interruptible::interruptible};

/// Makes pictures with labels from a database into a folder, with settings in JSON. Returns the numbers of pictures, of those that were made, of those
/// that were there, and of annotations.
#[pyfunction]
pub fn dataset(
    py: Python<'_>,
    database: Bound<'_, Database>,
    out: PathBuf,
    settings: &str,
) -> PyResult<(u32, u32, u32, usize)> {
    let settings: DatasetSettings = serde_json::from_str(settings)
        .map_err(|error| PyValueError::new_err(format!("settings: {error}")))?;
    let database = database.get();
    let source =
        DatasetSource::new(&database.path, database.synthesizer.clone()).with_model(database.model.clone());
    let made = interruptible(py, move || make(&source, &settings, &out, |_| ()))?.map_err(failed)?;
    Ok((made.pictures, made.written, made.skipped, made.annotations))
}
