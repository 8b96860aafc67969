//! `reality-sim dataset`: pictures at random poses with labels.

mod folder;
mod manifest;
mod options;
mod poses;
mod records;
mod things;
mod worker;

use std::{
    num::NonZero,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU32, Ordering},
    },
    thread,
    time::Instant,
};

use serde::Serialize;

use reality_sim::{Synthesizer, sequence::read_camera, simulator::Camera};

pub use self::options::DatasetArgs;
use self::{
    folder::DatasetFolder,
    manifest::Manifest,
    poses::Poses,
    records::write_annotations,
    things::Things,
    worker::{Task, Worker},
};
use super::{
    model_file::{ModelFile, Use},
    output::{aligned, frame_progress, print, print_json},
};

/// Report that `--json` prints.
#[derive(Serialize)]
struct Report {
    pictures: u32,
    /// Number of pictures that this run made.
    written: u32,
    /// Number of pictures that an earlier run had made.
    skipped: u32,
    annotations: usize,
    /// Pictures that this run made a second, with their files.
    pictures_per_second: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    corrections: Option<String>,
    out: String,
}

/// Runs the command.
pub fn run(args: &DatasetArgs) -> anyhow::Result<()> {
    let model = args.model.read()?;
    let archive = args.synthesis.archive(&args.database, model.as_ref())?;
    let lens = match &args.camera {
        Some(file) => read_camera(file)?.camera,
        None => archive.setup().camera.clone(),
    };
    let manifest = Manifest::new(args, &archive, &lens, model.as_ref())?;
    let inputs = [Some(&args.database), args.camera.as_ref(), args.model.model.as_ref()];
    let inputs: Vec<_> = inputs.into_iter().flatten().cloned().collect();
    let folder = DatasetFolder::check(args, &inputs, &manifest)?;
    let synthesizer = args.synthesis.synthesizer(archive.clone(), lens.clone())?;
    let camera = camera(args, synthesizer, model.as_ref())?;
    let task = Task {
        args,
        folder: &folder,
        poses: Poses { archive: &archive, seed: args.seed, within_px: args.within },
        things: Things {
            field: archive.field(),
            camera: &lens,
            seed: args.seed,
            balls: &args.balls,
            robots: &args.robots,
        },
    };
    let start = Instant::now();
    let Done { written, skipped } = make_all(&task, &camera)?;
    let seconds = start.elapsed().as_secs_f64();
    let purpose = Use::Pictures { is_corrected: archive.corrected_by().is_some() };
    let report = Report {
        pictures: args.count,
        written,
        skipped,
        annotations: write_annotations(args, &folder, archive.field())?,
        pictures_per_second: f64::from(written) / seconds.max(f64::MIN_POSITIVE),
        corrections: model.map(|model| model.words(archive.setup(), archive.field(), purpose)),
        out: args.out.display().to_string(),
    };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

fn camera(args: &DatasetArgs, synthesizer: Synthesizer, model: Option<&ModelFile>) -> anyhow::Result<Camera> {
    let camera = Camera::with(synthesizer.into(), args.method).with_labels(true);
    match model {
        Some(model) => camera.with_model(&model.model).map_err(|error| error.in_file(model.path()).into()),
        None => Ok(camera),
    }
}

/// Numbers of pictures that were made, and that were there.
struct Done {
    written: u32,
    skipped: u32,
}

/// Makes all pictures that are not there yet, on all cores. Each thread has a camera of its own, so that files are written while
/// other pictures are drawn.
fn make_all(task: &Task, camera: &Camera) -> anyhow::Result<Done> {
    let count = task.args.count;
    let progress = frame_progress(count as usize)?;
    let [next, written, skipped] = [0; 3].map(AtomicU32::new);
    let failed = Mutex::new(None);
    let work = |worker: &mut Worker| -> anyhow::Result<()> {
        while failed.lock().unwrap_or_else(PoisonError::into_inner).is_none() {
            let picture = next.fetch_add(1, Ordering::Relaxed);
            if picture >= count {
                break;
            }
            if task.folder.is_done(picture) {
                skipped.fetch_add(1, Ordering::Relaxed);
            } else {
                worker.make(picture)?;
                written.fetch_add(1, Ordering::Relaxed);
            }
            progress.inc(1);
        }
        Ok(())
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, NonZero::get) {
            scope.spawn(|| {
                if let Err(error) = work(&mut Worker::new(task, camera)) {
                    failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                }
            });
        }
    });
    progress.finish_and_clear();
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(Done { written: written.into_inner(), skipped: skipped.into_inner() }),
    }
}

impl Report {
    fn text(&self) -> String {
        let Self { pictures, written, skipped, annotations, pictures_per_second, .. } = self;
        let mut lines = vec![
            ("pictures", format!("{pictures}: {written} made, {skipped} there already")),
            ("labels", format!("{annotations} annotations")),
            ("speed", format!("{pictures_per_second:.1} pictures a second")),
        ];
        lines.extend(self.corrections.iter().map(|corrections| ("camera", corrections.clone())));
        lines.push(("folder", self.out.clone()));
        aligned(&lines)
    }
}
