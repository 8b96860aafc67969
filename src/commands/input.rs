//! Recordings that commands are given: sequences, or logs, which are imported first.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use reality_sim_formats::{Input, import::ImportOptions, log::Log};

use super::{
    import::{field_of, import_with_progress, name_of},
    output::notify,
};

/// Folder of a sequence. A temporary one is removed when this is dropped.
pub struct Recording {
    folder: PathBuf,
    _temporary: Option<TempDir>,
}

impl Recording {
    /// Takes the folder of a sequence as it is, and imports a log into a temporary folder, as `import` does without options.
    pub fn open(path: &Path, field: Option<&Path>) -> anyhow::Result<Self> {
        if Input::at(path) != Some(Input::Log) {
            return Ok(Self { folder: path.to_path_buf(), _temporary: None });
        }
        let options = ImportOptions::new(name_of(path), field_of(path, field)?);
        let temporary = tempfile::tempdir()?;
        let report = import_with_progress(&Log::open(path)?, &options, temporary.path())?;
        notify(&format!(
            "{}: a log, imported for this run ({} frames); `reality-sim import` keeps it and has options",
            path.display(),
            report.frames
        ));
        Ok(Self { folder: temporary.path().to_path_buf(), _temporary: Some(temporary) })
    }

    /// Returns the folder of the sequence.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}
