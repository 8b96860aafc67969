//! Data sets made from recordings.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use reality_sim_core::{
    sequence::Sequence,
    warp::{CpuWarper, MAX_SOURCES},
};
use reality_sim_synthesis::{SynthesisConfig, Synthesizer};
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{
    About, Findings, StudyError,
    built::{Building, Built, FILE},
};
use crate::dataset::{DatasetSettings, DatasetSource, make};

/// Settings with which pictures with labels are made from a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PictureSetSettings {
    /// Folder of the data set: of this recording with these settings alone.
    pub out: PathBuf,
    /// Whether the filter finds the poses even if the recording has reference poses.
    pub tag: bool,
    /// Seed of the filter.
    pub seed: u64,
    /// Number of pictures that `blend` mixes.
    pub neighbours: usize,
    /// Whether pictures are made however far away the nearest recorded one is.
    pub best_effort: bool,
    /// Whether what stood there while recording is left out.
    pub clean: bool,
    /// What is made.
    pub dataset: DatasetSettings,
}

impl Default for PictureSetSettings {
    fn default() -> Self {
        Self {
            out: PathBuf::from("pictures"),
            tag: false,
            seed: 0,
            neighbours: 6,
            best_effort: false,
            clean: false,
            dataset: DatasetSettings::default(),
        }
    }
}

/// Makes a data set from a recording, or completes one. What is found is the same whether it was there.
pub(super) fn make_pictures(
    about: About,
    sequence: &Sequence,
    settings: &PictureSetSettings,
) -> Result<Findings, StudyError> {
    sequence.check_pictures()?;
    let PictureSetSettings { tag, seed, clean, .. } = *settings;
    let built = Built::new(sequence, Building { tag, seed, clean, hold_back: None })?;
    let mut config =
        SynthesisConfig::new(&built.archive).with_sources(settings.neighbours.clamp(1, MAX_SOURCES));
    if settings.best_effort {
        config = config.best_effort();
    }
    let lens = sequence.setup.camera.clone();
    let synthesizer =
        Synthesizer::with(built.archive.clone(), lens, Arc::new(CpuWarper), config).with_clean(clean);
    let source = DatasetSource::new(Path::new(FILE), synthesizer).with_threads(rayon::current_num_threads());
    let made = make(&source, &settings.dataset, &settings.out, |_| ())?;
    let figures = [
        ("images", built.archive.images().len() as f64),
        ("pictures", f64::from(made.pictures)),
        ("annotations", made.annotations as f64),
    ];
    let figures = figures.map(|(name, value)| (name.to_owned(), Some(value)));
    Ok(Findings::new(about, figures, json!({ "folder": settings.out })))
}
