//! Options that `render` and `evaluate` share: opening of a database, and the device that draws.

use std::{path::Path, sync::Arc};

use clap::Args;

use reality_sim::{
    Archive, Camera, SynthesisError, Synthesizer, synthesis::SynthesisConfig, warp::MAX_SOURCES,
};

use super::{device::BackendArgs, model_file::ModelFile};

/// How pictures are made.
#[derive(Debug, Args)]
pub struct SynthesisArgs {
    /// Number of pictures that `blend` mixes
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u8).range(1..=MAX_SOURCES as i64))]
    neighbours: u8,
    /// Make a picture however far away the nearest recorded one is
    #[arg(long)]
    best_effort: bool,
    /// Leave out the people, robots and balls that stood there while the pictures were recorded
    #[arg(long)]
    clean: bool,
    /// Memory for decoded pictures, MiB
    #[arg(long, default_value_t = 1024, value_name = "MIB")]
    cache: u32,
    #[command(flatten)]
    pub backend: BackendArgs,
}

impl SynthesisArgs {
    /// Returns whether what stood there is left out.
    pub fn is_clean(&self) -> bool {
        self.clean
    }

    /// Opens a database, and evens out the light of its pictures by the model, if there is one.
    pub fn archive(&self, database: &Path, model: Option<&ModelFile>) -> anyhow::Result<Arc<Archive>> {
        let archive = Archive::open(database, (self.cache as usize) << 20)?;
        if self.clean && !archive.has_clean_stage() {
            return Err(SynthesisError::NoCleanStage { database: database.display().to_string() }.into());
        }
        Ok(Arc::new(match model {
            Some(model) => model.light(archive, database)?,
            None => archive,
        }))
    }

    /// Makes the synthesizer for pictures of a camera.
    pub fn synthesizer(&self, archive: Arc<Archive>, camera: Camera) -> anyhow::Result<Synthesizer> {
        let mut config = SynthesisConfig::new(&archive);
        config.sources = usize::from(self.neighbours);
        if self.best_effort {
            config = config.best_effort();
        }
        let warper = self.backend.device()?.backend.warper()?;
        Ok(Synthesizer::with(archive, camera, warper, config).with_clean(self.clean))
    }
}
