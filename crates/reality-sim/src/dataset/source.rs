//! What the pictures of a data set are made from.

use std::{
    num::NonZero,
    path::{Path, PathBuf},
    sync::Arc,
    thread,
};

use reality_sim_sensor::Model;
use reality_sim_simulator::Camera;
use reality_sim_synthesis::Synthesizer;

use super::{DatasetError, DatasetSettings};

/// What the pictures of a data set are made from.
#[derive(Debug)]
pub struct DatasetSource {
    database: PathBuf,
    synthesizer: Arc<Synthesizer>,
    model: Option<Model>,
    device: &'static str,
    threads: usize,
}

impl DatasetSource {
    /// Makes a source of a database's file and a synthesizer of its pictures.
    pub fn new(database: &Path, synthesizer: impl Into<Arc<Synthesizer>>) -> Self {
        let threads = thread::available_parallelism().map_or(1, NonZero::get);
        Self {
            database: database.to_path_buf(),
            synthesizer: synthesizer.into(),
            model: None,
            device: "cpu",
            threads,
        }
    }

    /// Adds the effects of a model to the pictures.
    pub fn with_model(self, model: Option<Model>) -> Self {
        Self { model, ..self }
    }

    /// Sets the name of the device on which the synthesizer draws, which the data set tells; it is `cpu` by default.
    pub fn with_device(self, device: &'static str) -> Self {
        Self { device, ..self }
    }

    /// Sets the number of threads; it is that of the cores by default. Pictures are the same with any number.
    pub fn with_threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    pub(super) fn database(&self) -> &Path {
        &self.database
    }

    /// Returns the name of the database's file: the data set stays the same where the file lies elsewhere.
    pub(super) fn name(&self) -> String {
        self.database.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    pub(super) fn synthesizer(&self) -> &Synthesizer {
        &self.synthesizer
    }

    pub(super) fn model(&self) -> Option<&Model> {
        self.model.as_ref()
    }

    pub(super) fn device(&self) -> &'static str {
        self.device
    }

    pub(super) fn threads(&self) -> usize {
        self.threads
    }

    pub(super) fn camera(&self, settings: &DatasetSettings) -> Result<Camera, DatasetError> {
        let camera = Camera::with(self.synthesizer.clone(), settings.method).with_labels(true);
        Ok(match &self.model {
            Some(model) => camera.with_model(model)?,
            None => camera,
        })
    }
}
