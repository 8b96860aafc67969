//! `reality-sim build`: recordings with their poses into a database.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::bail;
use clap::Args;
use serde::Serialize;

use reality_sim::{
    Archive, Sequence,
    db::{Database, IngestReport, PoseEstimate, PoseSource},
    localization::Picture,
    sequence::{match_poses, read_tum},
    synthesis::measure_hall,
    warp::Hall,
};

use super::{
    device::BackendArgs,
    filter::{Tagged, tagged},
    output::{aligned, check_output_file, frame_progress, print, print_json},
};

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
    /// Where it was measured now.
    #[serde(skip_serializing_if = "Option::is_none")]
    hall: Option<HallReport>,
}

/// Walls, ceiling and goals, from the field's centre.
#[derive(Serialize)]
struct HallReport {
    min_x_m: f64,
    min_y_m: f64,
    max_x_m: f64,
    max_y_m: f64,
    ceiling_m: f64,
    goal_depth_m: f64,
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
    if args.out.exists() {
        // Before the filter works for an hour: is it one?
        drop(Database::create_or_open(&args.out)?);
    }
    // All poses are known before a database is made.
    let poses: Vec<Poses> =
        sequences.iter().map(|sequence| poses(args, sequence)).collect::<Result<_, _>>()?;
    let mut database = Database::create_or_open(&args.out)?;
    let mut reports = Vec::new();
    for (sequence, poses) in sequences.iter().zip(&poses) {
        reports.push(add(sequence, poses, &mut database)?);
    }
    let images = database.images()?.len();
    let is_new = reports.iter().any(|report| report.added > 0) || database.halls()?.is_empty();
    let hall = if args.no_hall || !is_new { None } else { store_hall(&args.out, &mut database)? };
    let report = Report { database: args.out.display().to_string(), sequences: reports, images, hall };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

/// One pose a frame, where it has one, and where they are from.
struct Poses {
    estimates: Vec<Option<PoseEstimate>>,
    source: PoseSource,
}

fn add(sequence: &Sequence, poses: &Poses, database: &mut Database) -> anyhow::Result<SequenceReport> {
    let Poses { estimates, source } = poses;
    let progress = frame_progress(sequence.frames.len())?;
    let start = Instant::now();
    let ingested = database.ingest(sequence, estimates, source, |done| progress.set_position(done as u64));
    progress.finish_and_clear();
    let IngestReport { added, already_there, without_pose } = ingested?;
    let images_per_second = added as f64 / start.elapsed().as_secs_f64();
    let name = sequence.name.clone();
    Ok(SequenceReport { name, poses: source.kind(), added, already_there, without_pose, images_per_second })
}

fn poses(args: &BuildArgs, sequence: &Sequence) -> anyhow::Result<Poses> {
    if let Some(file) = &args.poses {
        let poses = match_poses(file, read_tum(file)?, &sequence.frames)?;
        if poses.iter().all(Option::is_none) {
            bail!("{}: holds no poses: make it with `tag --out`", file.display());
        }
        let name = file.display().to_string();
        let estimates = poses.into_iter().map(|pose| pose.map(PoseEstimate::from)).collect();
        return Ok(Poses { estimates, source: PoseSource::File { name } });
    }
    if !args.tag && sequence.has_reference_poses() {
        let estimates = sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
        return Ok(Poses { estimates, source: PoseSource::GroundTruth });
    }
    tagged_poses(args, sequence)
}

/// Poses by the filter, of the whole recording together.
fn tagged_poses(args: &BuildArgs, sequence: &Sequence) -> anyhow::Result<Poses> {
    let Tagged { frames, localizer, config, device } = tagged(sequence, &args.backend, args.seed)?;
    let smoothed =
        localizer.smoother().smooth(&frames, |index| sequence.load_image(index).map(Picture::from))?;
    let estimates = PoseEstimate::of_localized(&frames, smoothed.as_deref(), args.unsure);
    if estimates.iter().all(Option::is_none) {
        bail!(
            "{}: the filter is sure of no picture's pose: give the poses with --poses, or take them all with --unsure",
            sequence.folder.display()
        );
    }
    let program = concat!("reality-sim ", env!("CARGO_PKG_VERSION"));
    let source = PoseSource::of_filter(program, &config, &device, smoothed.is_some());
    Ok(Poses { estimates, source })
}

/// Measures the hall around the field that most images show, and keeps it.
fn store_hall(path: &Path, database: &mut Database) -> anyhow::Result<Option<HallReport>> {
    let archive = Archive::open(path, 0)?;
    let Some(hall) = measure_hall(&archive)? else { return Ok(None) };
    database.set_hall(archive.images()[0].field_id, &hall)?;
    let Hall { min_m, max_m, ceiling_m, goal_depth_m } = hall;
    Ok(Some(HallReport {
        min_x_m: min_m.x,
        min_y_m: min_m.y,
        max_x_m: max_m.x,
        max_y_m: max_m.y,
        ceiling_m,
        goal_depth_m,
    }))
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
        if let Some(HallReport { min_x_m, min_y_m, max_x_m, max_y_m, ceiling_m, .. }) = &self.hall {
            lines.push((
                "hall",
                format!("x {min_x_m:.1} to {max_x_m:.1} m, y {min_y_m:.1} to {max_y_m:.1} m, ceiling {ceiling_m:.1} m"),
            ));
        }
        lines.push(("database", format!("{}, {} pictures", self.database, self.images)));
        aligned(&lines)
    }
}
