//! A data set from beginning to end.

use std::{
    path::{Path, PathBuf},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU32, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use reality_sim_simulator::Camera;

use super::{
    DatasetError, DatasetSettings, DatasetSource,
    folder::DatasetFolder,
    manifest::Manifest,
    poses::Poses,
    records::write_annotations,
    things::Things,
    worker::{Task, Worker},
};

/// Data set that is whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dataset {
    /// Number of pictures.
    pub pictures: u32,
    /// Number of pictures that this run made.
    pub written: u32,
    /// Number of pictures that an earlier run had made.
    pub skipped: u32,
    /// Number of annotations of all pictures.
    pub annotations: usize,
    /// Time in which the pictures were made.
    pub drawing: Duration,
}

/// Makes a data set, or completes one that was begun with the same settings, in a folder that is there afterwards. `progress` is told,
/// by any thread, the number of pictures that are done.
pub fn make(
    source: &DatasetSource,
    settings: &DatasetSettings,
    out: &Path,
    progress: impl Fn(u32) + Sync,
) -> Result<Dataset, DatasetError> {
    let within = settings.within;
    if !(within.is_finite() && within > 0.0) {
        return Err(DatasetError::Within { within });
    }
    let manifest = Manifest::new(source, settings)?;
    let folder = DatasetFolder::check(PathBuf::from(out), settings, &manifest)?;
    let camera = source.camera(settings)?;
    let archive = source.synthesizer().archive();
    let task = Task {
        source,
        settings,
        folder: &folder,
        poses: Poses { archive, seed: settings.seed, within_px: within },
        things: Things {
            field: archive.field(),
            camera: source.synthesizer().camera(),
            seed: settings.seed,
            balls: settings.balls,
            robots: settings.robots,
        },
    };
    let start = Instant::now();
    let [written, skipped] = make_all(&task, &camera, progress)?;
    let drawing = start.elapsed();
    let annotations = write_annotations(source, settings, &folder)?;
    Ok(Dataset { pictures: settings.count, written, skipped, annotations, drawing })
}

/// Makes all pictures that are not there yet. Each thread has a camera of its own, so that files are written while other pictures are
/// drawn. Returns the numbers of pictures that were made, and that were there.
fn make_all(task: &Task, camera: &Camera, progress: impl Fn(u32) + Sync) -> Result<[u32; 2], DatasetError> {
    let [next, written, skipped] = [0; 3].map(AtomicU32::new);
    let failed = Mutex::new(None);
    let work = |worker: &mut Worker| -> Result<(), DatasetError> {
        while failed.lock().unwrap_or_else(PoisonError::into_inner).is_none() {
            let picture = next.fetch_add(1, Ordering::Relaxed);
            if picture >= task.settings.count {
                break;
            }
            if task.folder.is_done(picture) {
                skipped.fetch_add(1, Ordering::Relaxed);
            } else {
                worker.make(picture)?;
                written.fetch_add(1, Ordering::Relaxed);
            }
            progress(written.load(Ordering::Relaxed) + skipped.load(Ordering::Relaxed));
        }
        Ok(())
    };
    thread::scope(|scope| {
        for _ in 0..task.source.threads() {
            scope.spawn(|| {
                if let Err(error) = work(&mut Worker::new(task, camera)) {
                    failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                }
            });
        }
    });
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok([written.into_inner(), skipped.into_inner()]),
    }
}
