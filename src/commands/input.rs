//! Recordings that commands are given: sequences, or logs and models, which are imported first.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use reality_sim_formats::{Input, ModelImport, import::ImportOptions, log::Log};

use super::{
    import::{field_of, import_model, import_with_progress, name_of},
    output::notify,
};

/// Folder of a sequence. A temporary one is removed when this is dropped.
pub struct Recording {
    folder: PathBuf,
    _temporary: Option<TempDir>,
}

impl Recording {
    /// Takes the folder of a sequence as it is, and imports a log or a model into a temporary folder, as `import` does without options.
    pub fn open(path: &Path, field: Option<&Path>) -> anyhow::Result<Self> {
        let kind = match Input::at(path) {
            Some(kind @ (Input::Log | Input::ColmapModel | Input::Nerfstudio)) => kind,
            // What is nothing of all this is refused where its folder is opened.
            Some(Input::Sequence | Input::Table) | None => {
                return Ok(Self { folder: path.to_path_buf(), _temporary: None });
            }
        };
        let temporary = tempfile::tempdir()?;
        let (frames, what) = match kind {
            Input::Log => {
                let options = ImportOptions::new(name_of(path), field_of(path, field)?);
                (import_with_progress(&Log::open(path)?, &options, temporary.path())?.frames, "log")
            }
            _ => {
                let options = || Ok(ModelImport::new(&name_of(path), field_of(path, field)?));
                (import_model(kind, path, temporary.path(), options)?.frames, "model of another program")
            }
        };
        notify(&format!(
            "{}: a {what}, imported for this run ({frames} frames); `reality-sim import` keeps it and has options",
            path.display()
        ));
        Ok(Self { folder: temporary.path().to_path_buf(), _temporary: Some(temporary) })
    }

    /// Returns the folder of the sequence.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}
