//! `reality-sim build`: recordings with their poses into a database.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::bail;
use clap::Args;
use serde::Serialize;
use serde_json::json;

use reality_sim::{
    Archive, Sequence, TagConfig, Tagger,
    db::{Database, IngestReport, PoseEstimate, PoseSource},
    observation::ObservationKind,
    sequence::{match_poses, read_tum},
    synthesis::measure_hall,
    tag::{smooth_sequence, tag_sequence},
};

use super::{
    device::BackendArgs,
    output::{check_output_file, frame_progress, print, print_json},
};

/// Decoded pictures that the measuring of the hall may hold, bytes.
const HALL_CACHE_BYTES: usize = 512 << 20;

/// Options of `build`.
#[derive(Debug, Args)]
pub struct BuildArgs {
    /// Folders of the sequences: those that hold sequence.toml
    #[arg(required = true)]
    sequences: Vec<PathBuf>,
    /// The database, made where there is none; what it holds already is not added again
    #[arg(long, value_name = "DATABASE")]
    out: PathBuf,
    /// Poses of the pictures, as `tag --out` writes them, in place of the sequence's own
    #[arg(long, value_name = "FILE", conflicts_with = "tag")]
    poses: Option<PathBuf>,
    /// Tag the pictures with the particle filter even where the sequence has ground truth
    #[arg(long)]
    tag: bool,
    /// Take pictures with poses that the filter is not sure of, too
    #[arg(long)]
    unsure: bool,
    /// Seed of the particle filter
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    backend: BackendArgs,
    /// Do not measure where walls and ceiling are
    #[arg(long)]
    no_hall: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    database: String,
    sequences: Vec<SequenceReport>,
    /// In the database now.
    images: usize,
    /// Walls towards −x, −y, +x, +y, then the ceiling, metres from the field's centre.
    #[serde(skip_serializing_if = "Option::is_none")]
    hall_m: Option<[f64; 5]>,
}

#[derive(Serialize)]
struct SequenceReport {
    name: String,
    /// `groundtruth`, `file` or `filter`.
    poses: &'static str,
    added: usize,
    already_there: usize,
    /// Left out.
    without_pose: usize,
    /// Of storing alone.
    images_per_second: f64,
}

impl BuildArgs {
    /// Refuses one file of poses for several sequences.
    pub fn check_usage(&self) -> Result<(), String> {
        if self.poses.is_some() && self.sequences.len() > 1 {
            return Err(
                "--poses belongs to one sequence: give one, and the others in calls of their own".to_owned()
            );
        }
        self.backend.check_usage()
    }
}

/// Runs the command.
pub fn run(args: &BuildArgs) -> anyhow::Result<()> {
    let sequences: Vec<Sequence> =
        args.sequences.iter().map(|folder| Sequence::open(folder)).collect::<Result<_, _>>()?;
    let inputs: Vec<PathBuf> = sequences.iter().flat_map(|sequence| sequence.files.clone()).collect();
    check_output_file(&args.out, &inputs)?;
    let mut database = Database::create_or_open(&args.out)?;
    let mut reports = Vec::new();
    for sequence in &sequences {
        reports.push(add(args, sequence, &mut database)?);
    }
    let images = database.images()?.len();
    let hall_m = if args.no_hall || images == 0 { None } else { store_hall(&args.out, &mut database)? };
    let report = Report { database: args.out.display().to_string(), sequences: reports, images, hall_m };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

fn add(args: &BuildArgs, sequence: &Sequence, database: &mut Database) -> anyhow::Result<SequenceReport> {
    let (poses, source) = poses(args, sequence)?;
    if poses.iter().all(Option::is_none) {
        bail!(
            "{}: the filter is sure of no picture's pose: give the poses with --poses, or take them all with --unsure",
            sequence.folder.display()
        );
    }
    let progress = frame_progress(sequence.frames.len())?;
    let start = Instant::now();
    let ingested = database.ingest(sequence, &poses, &source, |done| progress.set_position(done as u64));
    progress.finish_and_clear();
    let IngestReport { added, already_there, without_pose } = ingested?;
    let images_per_second = added as f64 / start.elapsed().as_secs_f64();
    let name = sequence.name.clone();
    Ok(SequenceReport { name, poses: source.kind(), added, already_there, without_pose, images_per_second })
}

/// One pose a frame, where it has one, and where they are from.
fn poses(args: &BuildArgs, sequence: &Sequence) -> anyhow::Result<(Vec<Option<PoseEstimate>>, PoseSource)> {
    let known = |pose| PoseEstimate { pose, covariance: None };
    if let Some(file) = &args.poses {
        let poses = match_poses(file, read_tum(file)?, &sequence.frames)?;
        if poses.iter().all(Option::is_none) {
            bail!("{}: holds no poses: make it with `tag --out`", file.display());
        }
        let name = file.display().to_string();
        return Ok((poses.into_iter().map(|pose| pose.map(known)).collect(), PoseSource::File { name }));
    }
    let truth = &sequence.groundtruth;
    if !args.tag && truth.iter().any(Option::is_some) {
        return Ok((truth.iter().map(|pose| pose.map(known)).collect(), PoseSource::GroundTruth));
    }
    tagged_poses(args, sequence)
}

/// Poses by the filter, of the whole recording together.
fn tagged_poses(
    args: &BuildArgs,
    sequence: &Sequence,
) -> anyhow::Result<(Vec<Option<PoseEstimate>>, PoseSource)> {
    let mut config = TagConfig::new(ObservationKind::Contrast);
    config.filter.seed = args.seed;
    let device = args.backend.device()?;
    let Sequence { setup, field, start, .. } = sequence;
    let mut tagger = Tagger::with_backend(&setup.camera, field, *start, config, device.backend)?;
    let progress = frame_progress(sequence.frames.len())?;
    let tagged = tag_sequence(sequence, &mut tagger, |_, _, _, _| {
        progress.inc(1);
        Ok(())
    });
    progress.finish_and_clear();
    let tagged = tagged?;
    let smoothed = smooth_sequence(sequence, &tagger, &tagged)?;
    let estimate = |index: usize| match &smoothed {
        Some(smoothed) => {
            PoseEstimate { pose: smoothed[index].pose, covariance: Some(smoothed[index].covariance) }
        }
        None => {
            PoseEstimate { pose: tagged[index].pose, covariance: tagged[index].fit.map(|fit| fit.covariance) }
        }
    };
    let poses =
        tagged.iter().enumerate().map(|(index, frame)| (frame.sure || args.unsure).then(|| estimate(index)));
    let settings = json!({
        "program": concat!("reality-sim ", env!("CARGO_PKG_VERSION")),
        "observation": config.observation.kind,
        "particles": config.filter.particles,
        "iterations": config.filter.iterations,
        "resampling": config.filter.resampling,
        "seed": config.filter.seed,
        "backend": device.name,
        "smoothed": smoothed.is_some(),
    });
    Ok((poses.collect(), PoseSource::Filter { settings: settings.to_string() }))
}

/// Measures the hall around the field that most images show, and keeps it.
fn store_hall(path: &Path, database: &mut Database) -> anyhow::Result<Option<[f64; 5]>> {
    let archive = Archive::open(path, HALL_CACHE_BYTES)?;
    let Some(hall) = measure_hall(&archive)? else { return Ok(None) };
    database.set_hall(archive.images()[0].field_id, &hall)?;
    Ok(Some([hall.min_m.x, hall.min_m.y, hall.max_m.x, hall.max_m.y, hall.ceiling_m]))
}

impl Report {
    fn text(&self) -> String {
        let mut lines = Vec::new();
        for sequence in &self.sequences {
            let SequenceReport { name, poses, added, already_there, without_pose, .. } = sequence;
            let poses = match *poses {
                "groundtruth" => "its ground truth",
                "file" => "the file given",
                _ => "the particle filter",
            };
            lines.push((
                "sequence",
                format!("{name}: {added} pictures added, {already_there} were there, poses from {poses}"),
            ));
            if *without_pose > 0 {
                lines.push(("", format!("{without_pose} left out: no pose, or not sure")));
            }
        }
        if let Some([left, back, right, front, ceiling]) = self.hall_m {
            lines.push((
                "hall",
                format!("x {left:.1} to {right:.1} m, y {back:.1} to {front:.1} m, ceiling {ceiling:.1} m"),
            ));
        }
        lines.push(("database", format!("{}, {} pictures", self.database, self.images)));
        lines.iter().map(|(name, value)| format!("{name:10}{value}\n")).collect()
    }
}
