//! `--model`: the effects of a camera, which commands take into account beside its files.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;

use reality_sim::{
    Archive, FieldDimensions, Sequence,
    sensor::{CorrectionError, Model, Reach},
    sequence::CameraSetup,
};

/// Option of all commands that use a camera.
#[derive(Debug, Clone, Args)]
pub struct ModelArgs {
    /// Correct camera, field, poses and odometry by the effects in this model.toml, which `gap` writes
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
}

/// Model with the path of its file.
#[derive(Debug, Clone)]
pub struct ModelFile {
    path: PathBuf,
    pub model: Model,
}

/// What a command takes of a model.
#[derive(Debug, Clone, Copy)]
pub enum Use {
    /// Geometry, time and odometry, of a recording.
    Recording,
    /// Light, of the pictures in a database, which was built with the model or without it.
    Pictures { is_corrected: bool },
    /// Everything, of simulated pictures.
    Simulation,
}

impl ModelArgs {
    /// Reads the file, if one is given.
    pub fn read(&self) -> anyhow::Result<Option<ModelFile>> {
        let Some(path) = &self.model else { return Ok(None) };
        Ok(Some(ModelFile { path: path.clone(), model: Model::read(path)? }))
    }
}

impl ModelFile {
    /// Returns a recording as the model says that it truly is.
    pub fn correct(&self, sequence: &Sequence) -> anyhow::Result<Sequence> {
        self.model.correct(sequence).map_err(|error| match error {
            CorrectionError::Model(error) => error.in_file(&self.path).into(),
            error => anyhow::Error::new(error).context(sequence.folder.display().to_string()),
        })
    }

    /// Returns an archive whose pictures are mixed without falloff and gain. Refuses one that was built with another model.
    pub fn light(&self, archive: Archive, database: &Path) -> anyhow::Result<Archive> {
        if archive.corrected_by().is_some_and(|text| text != self.model.to_toml()) {
            bail!(
                "{}: was built with another model than {}: give that one, or build the database again with this one",
                database.display(),
                self.path.display()
            );
        }
        archive.with_model(&self.model).map_err(|error| error.in_file(&self.path).into())
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Says in one line what of the model is used, and what is not.
    pub fn words(&self, setup: &CameraSetup, field: &FieldDimensions, purpose: Use) -> String {
        let reaches = self.model.reaches(setup, field);
        let is_of_recording = |reach: Reach| reach.geometry || reach.time || reach.odometry;
        let is_used = |reach: Reach| match purpose {
            Use::Recording => is_of_recording(reach),
            Use::Pictures { is_corrected } => reach.shading || (is_corrected && is_of_recording(reach)),
            Use::Simulation => true,
        };
        let ids = |wanted: bool| {
            let ids = reaches.iter().filter(|(_, reach)| is_used(*reach) == wanted).map(|(id, _)| *id);
            ids.collect::<Vec<_>>().join(", ")
        };
        let rest = match purpose {
            Use::Recording => "which changes the light or the sharpness of pictures",
            Use::Pictures { is_corrected: true } | Use::Simulation => "which cannot be taken out of pictures",
            Use::Pictures { is_corrected: false } => {
                "which can only be corrected where the database is built, if at all"
            }
        };
        match [ids(true), ids(false)].each_ref().map(String::as_str) {
            ["", ""] => "changes nothing: it contains no effect".to_owned(),
            [used, ""] => format!("corrected by {used}"),
            ["", unused] => format!("nothing corrected: not by {unused}, {rest}"),
            [used, unused] => format!("corrected by {used}; not by {unused}, {rest}"),
        }
    }
}

/// Opens a recording and corrects it by the model, if there is one.
pub fn open_corrected(folder: &Path, model: Option<&ModelFile>) -> anyhow::Result<Sequence> {
    let sequence = Sequence::open(folder)?;
    model.map_or(Ok(sequence.clone()), |model| model.correct(&sequence))
}
