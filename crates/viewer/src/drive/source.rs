//! Source of the pictures: an opened database, or a temporary one made from a recording.

use std::sync::Arc;

use image::RgbImage;
use reality_sim_core::{pose::CameraPose, sequence::Sequence};
use reality_sim_db::metric::PixelMetric;
use reality_sim_pipeline::{self as pipeline, Event, FilterPlan, HoldBack, PipelineError, Plan, PoseChoice};
use reality_sim_sensor::Model;
use reality_sim_synthesis::Archive;

use super::work_folder::WorkFolder;
use crate::{background::Progress, device::Device, opening::CACHE_BYTES};

/// Pictures held back to compare with. Recordings with few poses need all of theirs.
const HOLD_BACK: HoldBack = HoldBack { every: 5, at_least: 10 };

/// Archive and, for a temporary one, the folder of its file, which is deleted when the last thread has released it.
#[derive(Debug)]
pub struct Source {
    pub archive: Arc<Archive>,
    /// True pictures that are not in the archive.
    pub probes: Option<Probes>,
    /// Effects of the camera, which things in the pictures go through.
    pub model: Option<Model>,
    /// Declared after the archive, which keeps a file in it open.
    _folder: Option<WorkFolder>,
}

impl Source {
    /// Takes a database that was opened.
    pub fn of_archive(archive: Arc<Archive>) -> Self {
        Self { archive, probes: None, model: None, _folder: None }
    }

    /// Lets things in the pictures go through the effects of a model.
    pub fn with_model(self, model: Option<Model>) -> Self {
        Self { model, ..self }
    }
}

/// Pictures of a recording with their camera poses.
#[derive(Debug, Clone)]
pub struct Probes {
    sequence: Arc<Sequence>,
    /// Frames and poses.
    poses: Arc<[(usize, CameraPose)]>,
}

/// Compares by identity.
impl PartialEq for Probes {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.poses, &other.poses)
    }
}

/// Probe near a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearProbe {
    pub frame: usize,
    pub pose: CameraPose,
    /// Distance by which the picture moves from the probe, root mean square pixels.
    pub distance_px: f64,
}

impl Probes {
    /// Takes the pictures of a recording that have reference poses; `None` if there are none.
    pub fn of_recording(sequence: &Arc<Sequence>) -> Option<Self> {
        let known = sequence.reference_poses().enumerate();
        Self::new(sequence, known.filter_map(|(frame, pose)| Some((frame, pose?))))
    }

    fn new(sequence: &Arc<Sequence>, poses: impl Iterator<Item = (usize, CameraPose)>) -> Option<Self> {
        let poses: Arc<[_]> = poses.collect();
        (!poses.is_empty()).then(|| Self { sequence: sequence.clone(), poses })
    }

    /// Returns the recording's name.
    pub fn name(&self) -> &str {
        &self.sequence.name
    }

    /// Returns frames and poses.
    pub fn poses(&self) -> &[(usize, CameraPose)] {
        &self.poses
    }

    /// Returns the probe from which the picture moves least.
    pub fn nearest(&self, metric: &PixelMetric, pose: CameraPose) -> Option<NearProbe> {
        let near = self.poses.iter().map(|&(frame, taken)| NearProbe {
            frame,
            pose: taken,
            distance_px: metric.distance_px(taken, pose),
        });
        near.min_by(|a, b| a.distance_px.total_cmp(&b.distance_px))
    }

    /// Reads the picture of a frame.
    pub fn picture(&self, frame: usize) -> Result<RgbImage, String> {
        self.sequence.load_image(frame).map_err(|error| error.to_string())
    }
}

/// Makes a database from a recording in a temporary file, by its reference poses or by those that the filter finds on a
/// device and is sure of. Measures the hall, and holds some pictures back as probes. The file is deleted with the returned
/// value, or before an error is returned.
pub fn build(
    sequence: &Arc<Sequence>,
    device: Option<&Device>,
    progress: &Progress,
) -> Result<Source, String> {
    let folder = WorkFolder::new_in(&std::env::temp_dir())
        .map_err(|error| format!("no temporary file can be made: {error}: make room, or set TMPDIR"))?;
    let path = folder.path().join("recording.db");
    let plan = Plan::new([sequence.clone()], PoseChoice::ReferenceElseFilter)
        .with_filter(filter_plan(device))
        .with_database(&path)
        .with_hold_back(HOLD_BACK);
    let mut probes = None;
    for event in plan.start() {
        stop_if_cancelled(progress)?;
        match event.map_err(|error| words(&error))? {
            Event::LocalizationStarted { .. } => progress.begin("Finding the poses …"),
            Event::Localized { index, of, .. } => progress.set(index + 1, of),
            Event::PosesFound { poses, .. } => probes = Probes::new(sequence, poses.held_back.into_iter()),
            Event::StorageStarted { .. } => progress.begin("Storing the pictures …"),
            Event::Stored { done, of, .. } => progress.set(done, of),
            Event::HallStarted => progress.begin("Measuring the hall …"),
            _ => {}
        }
    }
    stop_if_cancelled(progress)?;
    let archive = Archive::open(&path, CACHE_BYTES).map_err(|error| error.to_string())?;
    Ok(Source { archive: Arc::new(archive), probes, model: None, _folder: Some(folder) })
}

fn filter_plan(device: Option<&Device>) -> FilterPlan {
    let plan = FilterPlan::default().with_program(concat!("reality-sim viewer ", env!("CARGO_PKG_VERSION")));
    let device = device.cloned().unwrap_or_else(Device::processor);
    plan.with_device(Arc::new(move || {
        Ok(pipeline::Device { name: device.name().to_owned(), backend: device.open()? })
    }))
}

/// Returns the error's message with a remedy for this panel.
fn words(error: &PipelineError) -> String {
    match error {
        PipelineError::NothingSure { folder } => format!(
            "{}: the filter is sure of no picture's pose: watch it in Walk, or make a database with `reality-sim build` and `--poses`",
            folder.display()
        ),
        error => error.to_string(),
    }
}

/// Whether pictures are held back to compare with, for this number of poses.
pub fn holds_back(poses: usize) -> bool {
    poses >= HOLD_BACK.at_least
}

/// The message is never shown: the user who cancels knows.
fn stop_if_cancelled(progress: &Progress) -> Result<(), String> {
    if progress.is_cancelled() { Err("cancelled".to_owned()) } else { Ok(()) }
}
