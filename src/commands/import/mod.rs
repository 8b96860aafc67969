//! `reality-sim import`: makes a sequence of a robot's log, or of another program's model.

mod model;

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use reality_sim::{
    FieldDimensions,
    field::preset_names,
    sequence::{counted, on_one_line, read_camera, read_field},
};
use reality_sim_formats::{
    Input, ModelImport,
    import::{ImportOptions, ImportReport, TOLERANCE_S, import_log},
    log::Log,
};

pub use self::model::import_model;
use super::{
    output::{aligned, print, print_json, shows_progress},
    output_folder::OutputFolder,
    tag::field_by_name,
};

/// Options of `import`.
#[derive(Debug, Args)]
pub struct ImportArgs {
    /// Log (.mcap, .db3, rosbag2 folder), COLMAP model, transforms.json, or mapping.toml of a table with pictures
    input: PathBuf,
    /// Folder of the sequence, created if it does not exist
    #[arg(long, value_name = "SEQUENCE")]
    out: PathBuf,
    #[command(flatten)]
    topics: TopicArgs,
    /// Field on which it was recorded: a field.toml, or the name of a preset [default: field.toml beside the input]
    #[arg(long, value_name = "FILE|PRESET")]
    field: Option<PathBuf>,
    /// Camera to use instead of the log's calibration: a camera.toml
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Height of the camera above the carpet, metres [default: by tf, else by the reference poses]
    #[arg(long, value_name = "M", value_parser = height_m)]
    height_m: Option<f64>,
    /// Largest difference between the times of a picture and of what belongs to it, seconds
    #[arg(long, value_name = "S", default_value_t = TOLERANCE_S, value_parser = tolerance_s)]
    tolerance_s: f64,
    /// Folder of the pictures of a model [default: the model's own]
    #[arg(long, value_name = "FOLDER")]
    images: Option<PathBuf>,
    /// Pictures a second, for a model that does not have their times
    #[arg(long, value_name = "HZ", default_value_t = 10.0, value_parser = rate_hz)]
    rate_hz: f64,
    /// Write the first reference pose as the start of the sequence
    #[arg(long)]
    start_from_reference: bool,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

/// Topics and frames of a log. What is not given is found by its type.
#[derive(Debug, Args)]
struct TopicArgs {
    /// Topic of the pictures
    #[arg(long, value_name = "TOPIC")]
    image: Option<String>,
    /// Topic of the calibration
    #[arg(long, value_name = "TOPIC")]
    camera_info: Option<String>,
    /// Topic of the odometry
    #[arg(long, value_name = "TOPIC")]
    odometry: Option<String>,
    /// Topic of the reference poses, or the frame whose pose tf tells
    #[arg(long, value_name = "TOPIC|FRAME")]
    reference: Option<String>,
    /// Topic of the IMU
    #[arg(long, value_name = "TOPIC")]
    imu: Option<String>,
    /// Topic of the joints
    #[arg(long, value_name = "TOPIC")]
    joints: Option<String>,
    /// Frame of the camera [default: that which the pictures name]
    #[arg(long, value_name = "FRAME")]
    camera_frame: Option<String>,
    /// Frame on the ground that does not tilt [default: the odometry's, base_footprint, odom, or the root]
    #[arg(long, value_name = "FRAME")]
    base_frame: Option<String>,
}

#[derive(Serialize)]
struct Report<'a> {
    sequence: String,
    #[serde(flatten)]
    report: &'a ImportReport,
}

fn height_m(text: &str) -> Result<f64, String> {
    let height = text.parse().ok().filter(|height: &f64| *height > 0.0 && *height <= 100.0);
    height.ok_or_else(|| "give a number of metres above 0 and at most 100".to_owned())
}

fn tolerance_s(text: &str) -> Result<f64, String> {
    let tolerance = text.parse().ok().filter(|tolerance: &f64| (0.0..=10.0).contains(tolerance));
    tolerance.ok_or_else(|| "give a number of seconds from 0 to 10".to_owned())
}

fn rate_hz(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate: &f64| (0.001..=10_000.0).contains(rate));
    rate.ok_or_else(|| "give a number of pictures a second from 0.001 to 10000".to_owned())
}

/// Runs the command.
pub fn run(args: &ImportArgs) -> anyhow::Result<()> {
    let input = &args.input;
    match Input::at(input) {
        Some(Input::Log) => {}
        Some(Input::Sequence) => bail!("{}: is a sequence already: use it as it is", input.display()),
        Some(kind) => {
            OutputFolder::check(&args.out, std::slice::from_ref(input))?;
            let report = import_model(kind, input, &args.out, || args.model_options())?;
            return if args.json { print_json(&report) } else { print(&report.text()) };
        }
        None => {
            // The error of a log names what is wrong with the path.
            Log::open(input)?;
        }
    }
    let log = Log::open(input)?;
    let files: Vec<PathBuf> = log.files().map(Path::to_path_buf).collect();
    OutputFolder::check(&args.out, &files)?;
    let options = args.options()?;
    let report = import_with_progress(&log, &options, &args.out)?;
    if args.json {
        let sequence = args.out.display().to_string();
        return print_json(&Report { sequence, report: &report });
    }
    print(&text(&report, &args.out))
}

/// Imports a log, with progress on a terminal.
pub fn import_with_progress(log: &Log, options: &ImportOptions, out: &Path) -> anyhow::Result<ImportReport> {
    let bar = progress(log.bytes())?;
    let report = import_log(log, options, out, &mut |bytes| bar.set_position(bytes));
    bar.finish_and_clear();
    Ok(report?)
}

fn progress(bytes: u64) -> anyhow::Result<ProgressBar> {
    if !shows_progress() {
        return Ok(ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()));
    }
    let style =
        ProgressStyle::with_template("{bar:32} {bytes} of {total_bytes}, {bytes_per_sec}, {eta} left")?;
    Ok(ProgressBar::new(bytes).with_style(style))
}

impl ImportArgs {
    fn model_options(&self) -> anyhow::Result<ModelImport> {
        let field = field_of(&self.input, self.field.as_deref())?;
        let (images, rate_hz) = (self.images.clone(), self.rate_hz);
        Ok(ModelImport { images, rate_hz, ..ModelImport::new(&name_of(&self.input), field) })
    }

    fn options(&self) -> anyhow::Result<ImportOptions> {
        let field = field_of(&self.input, self.field.as_deref())?;
        let camera = self.camera.as_deref().map(read_camera).transpose()?;
        let topics = &self.topics;
        Ok(ImportOptions {
            image: topics.image.clone(),
            camera_info: topics.camera_info.clone(),
            odometry: topics.odometry.clone(),
            reference: topics.reference.clone(),
            imu: topics.imu.clone(),
            joints: topics.joints.clone(),
            camera_frame: topics.camera_frame.clone(),
            base_frame: topics.base_frame.clone(),
            camera,
            height_m: self.height_m,
            allows_uncalibrated: true,
            tolerance_s: self.tolerance_s,
            start_from_reference: self.start_from_reference,
            ..ImportOptions::new(name_of(&self.input), field)
        })
    }
}

/// Returns the name of a sequence that is made of an input: that of its file or folder.
pub fn name_of(input: &Path) -> String {
    let path = input.canonicalize().unwrap_or_else(|_| input.to_path_buf());
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    on_one_line(&name)
}

/// Returns the field on which a log was recorded: the given one, else that of the `field.toml` beside the log or in its folder.
pub fn field_of(input: &Path, given: Option<&Path>) -> anyhow::Result<FieldDimensions> {
    if let Some(given) = given {
        return field_by_name(given);
    }
    let beside = [Some(input), input.parent()].into_iter().flatten().map(|folder| folder.join("field.toml"));
    for file in beside {
        if fs::metadata(&file).is_ok_and(|metadata| metadata.is_file()) {
            return read_field(&file)
                .with_context(|| format!("{}: the field beside the log", input.display()));
        }
    }
    let presets: Vec<&str> = preset_names().collect();
    bail!(
        "{}: does not say on which field it was recorded: put a field.toml beside it, or give --field with a file or one of {}",
        input.display(),
        presets.join(", ")
    );
}

fn text(report: &ImportReport, out: &Path) -> String {
    let mut lines = vec![("frames", frames_text(report))];
    let faults = [
        (report.doubled, "doubled"),
        (report.lost, "lost"),
        (report.unusable, "unusable"),
        (report.without_stamp, "messages without a stamp: the log's time was taken"),
        (report.damaged, "other messages damaged"),
        (report.clock_jumps, "jumps of the clock"),
    ];
    lines.extend(
        faults.iter().filter(|(count, _)| *count > 0).map(|(count, what)| ("", format!("{count} {what}"))),
    );
    if report.salvaged {
        let lost = report.bytes_lost;
        lines.push((
            "salvaged",
            format!("the log is cut off or damaged: about {lost} bytes could not be read"),
        ));
    }
    let used = &report.topics;
    let topics = [
        ("pictures", &used.image),
        ("lens", &used.camera_info),
        ("odometry", &used.odometry),
        ("reference", &used.reference),
        ("imu", &used.imu),
    ];
    lines.extend(topics.iter().filter_map(|(what, name)| Some((*what, (*name).clone()?))));
    lines.push(("attitude", format!("pitch and roll from {}", report.attitude_source)));
    if let Some(words) = &report.odometry_source {
        lines.push(("", format!("odometry: {words}")));
    }
    let height = report.height_m.zip(report.height_source.as_ref());
    let height = height
        .map_or_else(|| "not known".to_owned(), |(height_m, from)| format!("{height_m:.3} m, from {from}"));
    lines.push(("height", height));
    lines.extend(report.notes.iter().map(|note| ("note", note.clone())));
    lines.push(("sequence", out.display().to_string()));
    aligned(&lines)
}

fn frames_text(report: &ImportReport) -> String {
    let frames = counted(report.frames, "frame");
    match report.unmatched {
        0 => frames,
        unmatched => format!(
            "{frames}; {unmatched} left out, of which the robot's pose is not known within {} s",
            report.tolerance_s
        ),
    }
}
