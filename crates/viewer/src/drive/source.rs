//! Where the pictures come from: a database that was opened, or one made of a recording for as long as it is looked at.

use std::sync::Arc;

use image::RgbImage;
use reality_sim_core::{
    localization::{LocalizedFrame, Localizer, LocalizerConfig, Picture},
    observation::ObservationKind,
    pose::CameraPose,
    sequence::Sequence,
};
use reality_sim_db::{Database, PoseEstimate, PoseSource, metric::PixelMetric};
use reality_sim_synthesis::{Archive, measure_hall};

use super::work_folder::WorkFolder;
use crate::{background::Progress, device::Device, opening::CACHE_BYTES};

/// Every so many-th picture is held back to compare with.
const PROBE_STEP: usize = 5;
/// Recordings with fewer poses than this need all of their pictures.
const LEAST_FRAMES: usize = 10;

/// An archive and, where it was made for now, the folder of its file: that is deleted when the last thread has gone.
#[derive(Debug)]
pub struct Source {
    pub archive: Arc<Archive>,
    /// True pictures that are not in the archive.
    pub probes: Option<Probes>,
    /// After the archive, which has a file of it open.
    _folder: Option<WorkFolder>,
}

impl Source {
    /// A database that was opened.
    pub fn of_archive(archive: Arc<Archive>) -> Self {
        Self { archive, probes: None, _folder: None }
    }
}

/// Pictures of a recording with the poses at which they were taken.
#[derive(Debug, Clone)]
pub struct Probes {
    sequence: Arc<Sequence>,
    /// Frames and poses.
    poses: Arc<[(usize, CameraPose)]>,
}

/// Whether they are the same ones, not only alike.
impl PartialEq for Probes {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.poses, &other.poses)
    }
}

/// A probe near a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearProbe {
    pub frame: usize,
    pub pose: CameraPose,
    /// How far the picture moves from it, root mean square pixels.
    pub distance_px: f64,
}

impl Probes {
    /// Those of a recording's pictures of which the pose is known; `None` where there are none.
    pub fn of_recording(sequence: &Arc<Sequence>) -> Option<Self> {
        let known = sequence.reference_poses().enumerate();
        Self::new(sequence, known.filter_map(|(frame, pose)| Some((frame, pose?))))
    }

    fn new(sequence: &Arc<Sequence>, poses: impl Iterator<Item = (usize, CameraPose)>) -> Option<Self> {
        let poses: Arc<[_]> = poses.collect();
        (!poses.is_empty()).then(|| Self { sequence: sequence.clone(), poses })
    }

    /// What the recording is called.
    pub fn name(&self) -> &str {
        &self.sequence.name
    }

    /// Frames and poses.
    pub fn poses(&self) -> &[(usize, CameraPose)] {
        &self.poses
    }

    /// The one that moves the picture least.
    pub fn nearest(&self, metric: &PixelMetric, pose: CameraPose) -> Option<NearProbe> {
        let near = self.poses.iter().map(|&(frame, taken)| NearProbe {
            frame,
            pose: taken,
            distance_px: metric.distance_px(taken, pose),
        });
        near.min_by(|a, b| a.distance_px.total_cmp(&b.distance_px))
    }

    /// The picture of a frame.
    pub fn picture(&self, frame: usize) -> Result<RgbImage, String> {
        self.sequence.load_image(frame).map_err(|error| error.to_string())
    }
}

/// What the filter weighs poses by.
const MODEL: ObservationKind = ObservationKind::Contrast;

/// One pose a frame, where it has one, and where they are from.
pub struct Poses {
    estimates: Vec<Option<PoseEstimate>>,
    source: PoseSource,
}

impl Poses {
    /// A recording's ground truth; `None` where it has none.
    pub fn known(sequence: &Sequence) -> Option<Self> {
        let estimates: Vec<_> = sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
        let is_known = estimates.iter().any(Option::is_some);
        is_known.then_some(Self { estimates, source: PoseSource::GroundTruth })
    }

    /// Found by the particle filter, of the whole recording together; those that it is not sure of are left out.
    pub fn found(sequence: &Sequence, device: Option<&Device>, progress: &Progress) -> Result<Self, String> {
        progress.begin("Finding the poses …");
        let (localizer, frames) = localized(sequence, device, progress)?;
        let picture = |index| sequence.load_image(index).map(Picture::from);
        let smoothed = localizer.smoother().smooth(&frames, picture).map_err(|error| error.to_string())?;
        let estimates = PoseEstimate::of_localized(&frames, smoothed.as_deref(), false);
        if estimates.iter().all(Option::is_none) {
            return Err(format!(
                "{}: the filter is sure of no picture's pose: watch it in Walk, or make a database with `reality-sim build` and `--poses`",
                sequence.folder.display()
            ));
        }
        let program = concat!("reality-sim viewer ", env!("CARGO_PKG_VERSION"));
        let device = device.map_or("processor", |device| &device.name);
        let source = PoseSource::of_filter(program, &LocalizerConfig::new(MODEL), device, smoothed.is_some());
        Ok(Self { estimates, source })
    }
}

fn localized(
    sequence: &Sequence,
    device: Option<&Device>,
    progress: &Progress,
) -> Result<(Localizer, Vec<LocalizedFrame>), String> {
    let Sequence { setup, field, start, .. } = sequence;
    let config = LocalizerConfig::new(MODEL);
    let mut builder = Localizer::builder(&setup.camera, field).config(config).start(*start);
    if let Some(device) = device {
        builder = builder.backend((device.open)().map_err(|error| error.to_string())?);
    }
    let mut localizer = builder.build().map_err(|error| error.to_string())?;
    let count = sequence.frames.len();
    let mut frames = Vec::with_capacity(count);
    for frame in localizer.run(sequence) {
        frames.push(frame.map_err(|error| error.to_string())?);
        progress.set(frames.len(), count);
        stop_if_cancelled(progress)?;
    }
    Ok((localizer, frames))
}

/// Makes a database of a recording in a temporary file, measures the hall, and holds some pictures back as probes. The file
/// is deleted with what is returned, or before an error is.
pub fn build(sequence: &Arc<Sequence>, poses: Poses, progress: &Progress) -> Result<Source, String> {
    let words = |error: &dyn std::error::Error| error.to_string();
    let Poses { mut estimates, source } = poses;
    let probes = held_back(sequence, &mut estimates);
    let folder = WorkFolder::new_in(&std::env::temp_dir())
        .map_err(|error| format!("no temporary file can be made: {error}: make room, or set TMPDIR"))?;
    let path = folder.path().join("recording.db");
    let mut database = Database::create_or_open(&path).map_err(|error| words(&error))?;
    let count = estimates.len();
    progress.begin("Storing the pictures …");
    let ingested = database.ingest_while(sequence, &estimates, &source, |done| {
        progress.set(done, count);
        !progress.is_cancelled()
    });
    ingested.map_err(|error| words(&error))?;
    stop_if_cancelled(progress)?;
    progress.begin("Measuring the hall …");
    let archive = Archive::open(&path, 0).map_err(|error| words(&error))?;
    if let Some(hall) = measure_hall(&archive).map_err(|error| words(&error))? {
        database.set_hall(archive.images()[0].field_id, &hall).map_err(|error| words(&error))?;
    }
    drop(archive);
    drop(database);
    stop_if_cancelled(progress)?;
    let archive = Archive::open(&path, CACHE_BYTES).map_err(|error| words(&error))?;
    Ok(Source { archive: Arc::new(archive), probes, _folder: Some(folder) })
}

/// Whether pictures are held back to compare with, where so many have poses.
pub fn holds_back(poses: usize) -> bool {
    poses >= LEAST_FRAMES
}

/// Takes some of the poses out: their pictures are the truth that others are compared with.
fn held_back(sequence: &Arc<Sequence>, estimates: &mut [Option<PoseEstimate>]) -> Option<Probes> {
    let known: Vec<usize> = (0..estimates.len()).filter(|&frame| estimates[frame].is_some()).collect();
    if !holds_back(known.len()) {
        return None;
    }
    let held = known.iter().skip(PROBE_STEP / 2).step_by(PROBE_STEP);
    let poses: Vec<_> = held.filter_map(|&frame| Some((frame, estimates[frame].take()?.pose))).collect();
    Probes::new(sequence, poses.into_iter())
}

/// The words are never seen: who cancels knows.
fn stop_if_cancelled(progress: &Progress) -> Result<(), String> {
    if progress.is_cancelled() { Err("cancelled".to_owned()) } else { Ok(()) }
}
