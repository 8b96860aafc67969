//! `reality-sim build`: stores recordings with their poses, and the pictures of other databases, in a database.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use anyhow::{anyhow, bail};
use clap::Args;
use serde::Serialize;

use reality_sim::{
    Sequence,
    db::{Database, IngestReport},
    pipeline::{CleanStageSummary, Event, PipelineError, Plan, PoseChoice},
    sequence::counted,
    warp::Hall,
};

use super::{
    device::BackendArgs,
    filter::{filter_plan, pose_error},
    input::Recording,
    model_file::{ModelArgs, Use, open_corrected},
    output::{StageProgress, aligned, check_output_file, print, print_json},
};

/// Options of `build`.
#[derive(Debug, Args)]
pub struct BuildArgs {
    /// Folders of the sequences, which contain sequence.toml, robots' logs, or databases, whose pictures are added
    #[arg(required = true, value_name = "SEQUENCE|DATABASE")]
    sequences: Vec<PathBuf>,
    /// Database to add to, created if it does not exist; pictures that it contains are not added again
    #[arg(long, value_name = "DATABASE")]
    out: PathBuf,
    /// Field on which logs were recorded: a field.toml, or the name of a preset
    #[arg(long, value_name = "FILE|PRESET")]
    field: Option<PathBuf>,
    /// Poses to use instead of the sequence's own, as `tag --out` writes them
    #[arg(long, value_name = "FILE", conflicts_with = "tag")]
    poses: Option<PathBuf>,
    /// Find the poses by the particle filter, even if the sequence has ground truth
    #[arg(long)]
    tag: bool,
    /// Also store pictures of whose poses the filter is not sure
    #[arg(long)]
    unsure: bool,
    /// Seed of the particle filter
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    backend: BackendArgs,
    /// Do not measure the walls and the ceiling of the hall
    #[arg(long)]
    no_hall: bool,
    /// Do not look for the people, robots and balls that stood on the carpet: pictures without them cannot be made
    #[arg(long)]
    no_clean: bool,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Default, Serialize)]
struct Report {
    database: String,
    sequences: Vec<SequenceReport>,
    /// Databases whose pictures were added.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    databases: Vec<DatabaseReport>,
    /// Number of images now in the database.
    images: usize,
    /// The hall, if it was measured in this run.
    #[serde(skip_serializing_if = "Option::is_none")]
    hall: Option<HallReport>,
    /// The clean stage, if it was found in this run.
    #[serde(skip_serializing_if = "Option::is_none")]
    clean: Option<CleanReport>,
    /// What of the model was used.
    #[serde(skip_serializing_if = "Option::is_none")]
    corrections: Option<String>,
}

/// Distances of walls, ceiling and goals from the field's centre.
#[derive(Serialize)]
struct HallReport {
    min_x_m: f64,
    min_y_m: f64,
    max_x_m: f64,
    max_y_m: f64,
    ceiling_m: f64,
    goal_depth_m: f64,
}

/// What was found on the carpet.
#[derive(Serialize)]
struct CleanReport {
    /// Number of images that show something on the carpet.
    masked_images: usize,
    /// Share of the carpet that no image shows empty.
    unknown_share: f64,
}

#[derive(Serialize)]
struct DatabaseReport {
    database: String,
    added: usize,
    replaced: usize,
    already_there: usize,
}

#[derive(Serialize)]
struct SequenceReport {
    name: String,
    /// Source of the poses: `groundtruth`, `file` or `filter`.
    poses: &'static str,
    added: usize,
    /// Number of pictures that were there, but could not be decoded.
    replaced: usize,
    already_there: usize,
    /// Number of frames that were left out.
    without_pose: usize,
    /// Speed of storage alone.
    images_per_second: f64,
}

impl BuildArgs {
    /// Refuses a single file of poses for several sequences.
    pub fn check_usage(&self) -> Result<(), String> {
        if self.poses.is_some() && self.sequences.len() > 1 {
            return Err("--poses gives the poses of one sequence: add the other sequences in separate calls"
                .to_owned());
        }
        self.backend.check_usage()
    }
}

/// Runs the command.
pub fn run(args: &BuildArgs) -> anyhow::Result<()> {
    let model = args.model.read()?;
    let field = args.field.as_deref();
    let (databases, sequences) = args.databases_and_sequences()?;
    let recordings: Vec<Recording> =
        sequences.iter().map(|path| Recording::open(path, field)).collect::<Result<_, _>>()?;
    let open = |recording: &Recording| open_corrected(recording.folder(), model.as_ref()).map(Arc::new);
    let sequences: Vec<Arc<Sequence>> = recordings.iter().map(open).collect::<Result<_, _>>()?;
    let mut inputs: Vec<PathBuf> = sequences.iter().flat_map(|sequence| sequence.files.clone()).collect();
    inputs.extend(databases.iter().cloned().chain(args.model.model.clone()));
    check_output_file(&args.out, &inputs)?;
    let corrections =
        model.map(|model| model.words(&sequences[0].setup, &sequences[0].field, Use::Recording));
    let mut report = Report { database: args.out.display().to_string(), corrections, ..Report::default() };
    let mut sources: Vec<&'static str> = Vec::new();
    let mut progress = StageProgress::default();
    for event in args.plan(&sequences).with_databases(databases.clone()).start() {
        match event.map_err(with_options).inspect_err(|_| progress.finish())? {
            Event::LocalizationStarted { frames, .. } | Event::StorageStarted { frames, .. } => {
                progress.begin(frames)?;
            }
            Event::CopyingStarted { images, .. } => progress.begin(images)?,
            Event::Copied { done, .. } => progress.set(done),
            Event::DatabaseAdded { database, report: added } => {
                report.databases.push(DatabaseReport::new(&databases[database], added));
            }
            Event::Localized { index, .. } => progress.set(index + 1),
            Event::Stored { done, .. } => progress.set(done),
            Event::PosesFound { poses, .. } => sources.push(poses.source.kind()),
            Event::Ingested { recording, report: ingested, seconds } => {
                let name = sequences[recording].name.clone();
                report.sequences.push(SequenceReport::new(name, sources[recording], ingested, seconds));
            }
            Event::HallStarted => progress.finish(),
            Event::CleanStageStarted { images } => progress.begin(images)?,
            Event::Cleaned { done, .. } => progress.set(done),
            Event::CleanStageFound(found) => report.clean = Some(CleanReport::new(found)),
            Event::Completed { images, hall } => {
                (report.images, report.hall) = (images, hall.as_ref().map(HallReport::new));
            }
            _ => {}
        }
    }
    progress.finish();
    if args.json { print_json(&report) } else { print(&report.text()) }
}

impl BuildArgs {
    /// Tells databases from all else that is given. What they hold was corrected, and has its poses.
    fn databases_and_sequences(&self) -> anyhow::Result<(Vec<PathBuf>, Vec<PathBuf>)> {
        let (databases, sequences): (Vec<_>, Vec<_>) =
            self.sequences.iter().cloned().partition(|path| Database::is_at(path));
        if let (Some(database), Some(_)) = (databases.first(), &self.model.model) {
            bail!(
                "{}: is a database: --model corrects recordings only, before they are stored: add databases in a call without it",
                database.display()
            );
        }
        Ok((databases, sequences))
    }

    fn plan(&self, sequences: &[Arc<Sequence>]) -> Plan {
        let poses = match &self.poses {
            Some(file) => PoseChoice::File(file.clone()),
            None if self.tag => PoseChoice::Filter,
            None => PoseChoice::ReferenceElseFilter,
        };
        let filter = filter_plan(&self.backend, self.seed).with_unsure(self.unsure);
        Plan::new(sequences.iter().cloned(), poses)
            .with_filter(filter)
            .with_database(&self.out)
            .with_hall(!self.no_hall)
            .with_clean_stage(!self.no_clean)
    }
}

/// Adds the options that remedy an error.
fn with_options(error: PipelineError) -> anyhow::Error {
    match error {
        PipelineError::NothingSure { folder } => anyhow!(
            "{}: the filter is not sure of any picture's pose: give the poses with --poses, or store all with --unsure",
            folder.display()
        ),
        error => pose_error(error),
    }
}

impl SequenceReport {
    fn new(name: String, poses: &'static str, report: IngestReport, seconds: f64) -> Self {
        let IngestReport { added, replaced, already_there, without_pose } = report;
        let images_per_second = added as f64 / seconds;
        Self { name, poses, added, replaced, already_there, without_pose, images_per_second }
    }
}

impl DatabaseReport {
    fn new(path: &Path, report: IngestReport) -> Self {
        let IngestReport { added, replaced, already_there, .. } = report;
        Self { database: path.display().to_string(), added, replaced, already_there }
    }
}

impl HallReport {
    fn new(hall: &Hall) -> Self {
        let Hall { min_m, max_m, ceiling_m, goal_depth_m } = *hall;
        Self {
            min_x_m: min_m.x,
            min_y_m: min_m.y,
            max_x_m: max_m.x,
            max_y_m: max_m.y,
            ceiling_m,
            goal_depth_m,
        }
    }
}

impl CleanReport {
    fn new(found: CleanStageSummary) -> Self {
        let CleanStageSummary { masked_images, unknown_share } = found;
        Self { masked_images, unknown_share }
    }
}

impl Report {
    fn text(&self) -> String {
        let mut lines = Vec::new();
        for DatabaseReport { database, added, replaced, already_there } in &self.databases {
            let added = counted(*added, "picture");
            lines.push(("pictures", format!("of {database}: {added} added, {already_there} already there")));
            lines.extend(replaced_line(*replaced));
        }
        for sequence in &self.sequences {
            let SequenceReport { name, poses, added, replaced, already_there, without_pose, .. } = sequence;
            let poses = match *poses {
                "groundtruth" => "its ground truth",
                "file" => "the file given",
                _ => "the particle filter",
            };
            lines.push((
                "sequence",
                format!(
                    "{name}: {} added, {already_there} already there, poses from {poses}",
                    counted(*added, "picture")
                ),
            ));
            lines.extend(replaced_line(*replaced));
            if *without_pose > 0 {
                lines.push((
                    "",
                    format!("{without_pose} left out: without a pose, or with one that is not sure"),
                ));
            }
        }
        if let Some(HallReport { min_x_m, min_y_m, max_x_m, max_y_m, ceiling_m, .. }) = &self.hall {
            lines.push((
                "hall",
                format!("x {min_x_m:.1} to {max_x_m:.1} m, y {min_y_m:.1} to {max_y_m:.1} m, ceiling {ceiling_m:.1} m"),
            ));
        }
        if let Some(CleanReport { masked_images, unknown_share }) = &self.clean {
            let masked = counted(*masked_images, "picture");
            let seen = 100.0 * (1.0 - unknown_share);
            lines.push((
                "clean",
                format!("things on the carpet in {masked}; {seen:.0} % of the carpet were seen empty"),
            ));
        }
        lines.extend(self.corrections.iter().map(|corrections| ("camera", corrections.clone())));
        lines.push(("database", format!("{}, {}", self.database, counted(self.images, "picture"))));
        aligned(&lines)
    }
}

/// Says how many pictures were replaced, if any.
fn replaced_line(replaced: usize) -> Option<(&'static str, String)> {
    (replaced > 0).then(|| ("", format!("{replaced} replaced, which could not be decoded any more")))
}
