//! Findings about the pictures that are made from recordings.

use std::{path::PathBuf, sync::Arc};

use image::RgbImage;
use reality_sim_core::{
    pose::CameraPose,
    sequence::Sequence,
    warp::{CpuWarper, MAX_SOURCES},
};
use reality_sim_pipeline::HoldBack;
use reality_sim_sensor::{Renderer, SceneColors};
use reality_sim_synthesis::{Archive, SynthesisConfig, SynthesisError, Synthesizer};
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{
    About, Findings, StudyError,
    built::{Building, Built, CACHE_BYTES},
};
use crate::probing::{MethodReport, Outcome, ProbeResult, compare_methods, names};

/// Least number of poses of a recording of which some are held back.
const LEAST_POSES: usize = 10;

/// Settings with which pictures made from a database are compared with those of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EvaluationSettings {
    /// Database whose pictures are compared with the recording's. `None` makes one of the recording itself, without the pictures that
    /// it is compared with.
    pub database: Option<PathBuf>,
    /// Which of the recording's pictures are left out of its own database: one in so many.
    pub every: usize,
    /// Number of pictures that `blend` mixes.
    pub neighbours: usize,
    /// Whether pictures are made however far away the nearest recorded one is.
    pub best_effort: bool,
    /// Whether what stood there while recording is left out.
    pub clean: bool,
    /// Whether the filter finds the poses even if the recording has reference poses; for a recording's own database only.
    pub tag: bool,
    /// Seed of the filter.
    pub seed: u64,
}

impl Default for EvaluationSettings {
    fn default() -> Self {
        Self {
            database: None,
            every: 10,
            neighbours: 6,
            best_effort: false,
            clean: false,
            tag: false,
            seed: 0,
        }
    }
}

/// Database, and the frames that it is compared with, with their poses.
struct Probes {
    archive: Arc<Archive>,
    frames: Vec<(usize, CameraPose)>,
    /// Holds the file of a database of its own.
    _built: Option<Built>,
}

/// Compares pictures by all methods with those of a recording.
pub(super) fn evaluate(
    about: About,
    sequence: &Sequence,
    settings: &EvaluationSettings,
) -> Result<Findings, StudyError> {
    sequence.check_pictures()?;
    let probes = match &settings.database {
        Some(_) => Probes::all(sequence, settings)?,
        None => Probes::held_back(sequence, settings)?,
    };
    let (archive, field) = (&probes.archive, probes.archive.field());
    if settings.clean && !archive.has_clean_stage() {
        let database = settings.database.as_ref().map_or_else(String::new, |path| path.display().to_string());
        return Err(SynthesisError::NoCleanStage { database }.into());
    }
    let mut config = SynthesisConfig::new(archive).with_sources(settings.neighbours.clamp(1, MAX_SOURCES));
    if settings.best_effort {
        config = config.best_effort();
    }
    let camera = sequence.setup.camera.clone();
    let synthesizer = Synthesizer::with(archive.clone(), camera, Arc::new(CpuWarper), config);
    let synthesizer = synthesizer.with_clean(settings.clean);
    let renderer = Renderer::new(&sequence.setup, field, SceneColors::new(&sequence.setup, field));
    let mut results = Vec::new();
    for &(frame, pose) in &probes.frames {
        let truth = sequence.load_image(frame)?;
        let result = compare_methods(&synthesizer, &renderer, frame, pose, truth)?;
        results.push(without_pictures(result));
    }
    Ok(findings(about, archive, &results))
}

impl Probes {
    /// Takes all pictures of the recording whose poses are known.
    fn all(sequence: &Sequence, settings: &EvaluationSettings) -> Result<Self, StudyError> {
        let path = settings.database.as_deref().unwrap_or_else(|| unreachable!("asked for with one only"));
        let frames = sequence.reference_poses().enumerate();
        let frames: Vec<_> = frames.filter_map(|(frame, pose)| Some((frame, pose?))).collect();
        if frames.is_empty() {
            let fault =
                "has no ground truth: give a recording with the true poses of its pictures, or no database";
            return Err(StudyError::NoProbes { recording: sequence.name.clone(), fault });
        }
        let archive = Arc::new(Archive::open(path, CACHE_BYTES)?);
        Ok(Self { archive, frames, _built: None })
    }

    /// Stores a part of the recording, and takes the other.
    fn held_back(sequence: &Sequence, settings: &EvaluationSettings) -> Result<Self, StudyError> {
        let EvaluationSettings { tag, seed, clean, .. } = *settings;
        let hold_back = Some(HoldBack { every: settings.every.max(2), at_least: LEAST_POSES });
        let built = Built::new(sequence, Building { tag, seed, clean, hold_back })?;
        if built.held_back.is_empty() {
            let fault = "too few of its pictures have a pose for some of them to be left out: record more";
            return Err(StudyError::NoProbes { recording: sequence.name.clone(), fault });
        }
        let (archive, frames) = (built.archive.clone(), built.held_back.clone());
        Ok(Self { archive, frames, _built: Some(built) })
    }
}

/// Says of each method how good its pictures are; the time is not among it.
fn findings(about: About, archive: &Archive, results: &[ProbeResult]) -> Findings {
    let mut figures = vec![
        ("probes".to_owned(), Some(results.len() as f64)),
        ("images".to_owned(), Some(archive.images().len() as f64)),
    ];
    for method in names() {
        let MethodReport { psnr_db, psnr_field_db, ssim, answered, .. } = MethodReport::new(method, results);
        let values = [
            ("psnr_db", psnr_db),
            ("psnr_field_db", psnr_field_db),
            ("ssim", ssim),
            ("answered", Some(answered)),
        ];
        figures.extend(values.map(|(figure, value)| (format!("{method}_{figure}"), value)));
    }
    let report =
        json!({ "distances_px": results.iter().map(|result| result.distance_px).collect::<Vec<_>>() });
    Findings::new(about, figures, report)
}

/// Drops the pictures of a probe: those of all probes would fill the memory.
fn without_pictures(result: ProbeResult) -> ProbeResult {
    let outcomes = result.outcomes.into_iter();
    let outcomes =
        outcomes.map(|(name, outcome)| (name, Outcome { picture: RgbImage::default(), ..outcome }));
    ProbeResult { truth: RgbImage::default(), outcomes: outcomes.collect(), ..result }
}
