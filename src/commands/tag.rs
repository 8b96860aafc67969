//! `reality-sim tag`: a camera pose for every picture of a sequence.

use std::{
    fmt::Write,
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use image::RgbImage;
use serde::Serialize;

use reality_sim::{
    CameraPose, FieldDimensions, ObservationKind, Pose2, Sequence, StampedPose, TagConfig, TaggedFrame,
    Tagger,
    evaluation::{ErrorStatistics, PoseError, percentile},
    field::preset_names,
    filter::{Estimator, KldConfig, Resampling},
    overlay::{BorderOutline, Overlay},
    refine::SmoothedPose,
    sequence::{read_camera, read_field, save_image},
    tag::{recorded, smooth_sequence, tag_sequence},
    write_tum,
};

use super::output::{
    check_output_file, create_output_folder, frame_progress, print, print_json, write_atomically,
};

/// Odometry that jumps to its origin by more than this was reset, metres.
const RESET_JUMP_M: f64 = 0.1;

/// Options of `tag`.
#[derive(Debug, Args)]
pub struct TagArgs {
    /// Folder of the sequence: the one that holds sequence.toml
    sequence: PathBuf,
    /// Model that weighs the particles
    #[arg(long, value_enum, default_value = "contrast")]
    observation: Observation,
    /// Number of particles; with --adaptive the largest number
    #[arg(long, default_value_t = 800, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    particles: u32,
    /// Rounds of weighing and resampling for every picture
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    iterations: u32,
    /// How the particles that survive are chosen
    #[arg(long, value_enum, default_value = "residual")]
    resampling: ResamplingScheme,
    /// How the filter's pose is taken from the particles
    #[arg(long, value_enum, default_value = "best")]
    estimator: EstimatorKind,
    /// Adapt the number of particles to their spread (KLD sampling)
    #[arg(long)]
    adaptive: bool,
    /// Use the whole recording for every pose: fit each picture to a fraction of a pixel, then all pictures, odometry and
    /// IMU together
    #[arg(long)]
    smooth: bool,
    /// Same seed, same result
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where the particles are weighed
    #[arg(long, value_enum, default_value = "auto")]
    backend: Backend,
    /// Sigma of the picture's Gaussian blur, pixels (gauss and contrast) [default: the model's own]
    #[arg(long, value_name = "PX", value_parser = blur_px)]
    blur: Option<f32>,
    /// The paper's α (gauss and distance), above 0 [default: the model's own]
    #[arg(long, value_name = "A", value_parser = positive)]
    alpha: Option<f64>,
    /// Keep what the picture shows outside the field's border (gauss and distance)
    #[arg(long)]
    no_border_mask: bool,
    /// Predict from the previous picture alone, as in the paper
    #[arg(long)]
    no_odometry: bool,
    /// Pose of the first picture: metres, metres, radians [default: the sequence's]
    #[arg(long, value_name = "X,Y,YAW", value_parser = start_pose, allow_hyphen_values = true)]
    start: Option<Pose2>,
    /// Find the pose of the first picture, whatever the sequence says
    #[arg(long, conflicts_with = "start")]
    unknown_start: bool,
    /// Never search the field for a lost pose
    #[arg(long)]
    no_recovery: bool,
    /// A field.toml or the name of a preset in place of the sequence's field
    #[arg(long, value_name = "FILE|PRESET")]
    field: Option<PathBuf>,
    /// A camera.toml in place of the sequence's
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Write the poses, as a TUM file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write pose, standard deviations and the filter's state of every picture, as a CSV file
    #[arg(long, value_name = "FILE")]
    details: Option<PathBuf>,
    /// Write every picture with lines, border, particles and a map drawn into it
    #[arg(long, value_name = "FOLDER")]
    overlay: Option<PathBuf>,
    /// Only these pictures, counted from 0, without B; the start is then dead-reckoned by odometry
    #[arg(long, value_name = "A..B", value_parser = frame_range)]
    frames: Option<FrameRange>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Observation {
    /// The paper's Eq. 2: grey values on the projected lines
    Gauss,
    /// The paper's Eq. 1: distances from projected to white lines
    Distance,
    /// Lines against their flanks, all six degrees of freedom, sub-pixel fit
    Contrast,
}

impl From<Observation> for ObservationKind {
    fn from(observation: Observation) -> Self {
        match observation {
            Observation::Gauss => Self::Gauss,
            Observation::Distance => Self::Distance,
            Observation::Contrast => Self::Contrast,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ResamplingScheme {
    Residual,
    Systematic,
    Stratified,
    Multinomial,
}

impl From<ResamplingScheme> for Resampling {
    fn from(scheme: ResamplingScheme) -> Self {
        match scheme {
            ResamplingScheme::Residual => Self::Residual,
            ResamplingScheme::Systematic => Self::Systematic,
            ResamplingScheme::Stratified => Self::Stratified,
            ResamplingScheme::Multinomial => Self::Multinomial,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum EstimatorKind {
    /// The particle with the largest weight, as in the paper
    Best,
    /// Weighted mean of all particles
    Mean,
    /// Weighted mean of the particles around the best
    Cluster,
}

impl From<EstimatorKind> for Estimator {
    fn from(kind: EstimatorKind) -> Self {
        match kind {
            EstimatorKind::Best => Self::Best,
            EstimatorKind::Mean => Self::Mean,
            EstimatorKind::Cluster => Self::Cluster,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Backend {
    /// The fastest one that is there
    Auto,
    Cpu,
    Gpu,
}

/// A half-open range, open where nothing is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct FrameRange {
    first: usize,
    end: Option<usize>,
}

fn frame_range(text: &str) -> Result<FrameRange, String> {
    let form = || "give A..B, A.. or ..B with A below B, counted from 0".to_owned();
    let (first, end) = text.split_once("..").ok_or_else(form)?;
    let number =
        |text: &str| if text.is_empty() { Ok(None) } else { text.parse().map(Some).map_err(|_| form()) };
    let (first, end) = (number(first)?.unwrap_or(0), number(end)?);
    if end.is_some_and(|end| end <= first) { Err(form()) } else { Ok(FrameRange { first, end }) }
}

fn start_pose(text: &str) -> Result<Pose2, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x_m, y_m, yaw_rad]) if x_m.is_finite() && y_m.is_finite() && yaw_rad.is_finite() => {
            Ok(Pose2::new(x_m, y_m, yaw_rad))
        }
        _ => Err("give three finite numbers: metres, metres, radians".to_owned()),
    }
}

fn blur_px(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|sigma| (0.0..=50.0).contains(sigma))
        .ok_or_else(|| "give a number of pixels from 0 to 50".to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|value: &f64| value.is_finite() && *value > 0.0)
        .ok_or_else(|| "give a number above 0".to_owned())
}

impl TagArgs {
    /// Refuses options that the observation model would ignore.
    pub fn check_usage(&self) -> Result<(), String> {
        let (contrast, distance) =
            (self.observation == Observation::Contrast, self.observation == Observation::Distance);
        let ignored = [
            ("--alpha", self.alpha.is_some() && contrast),
            ("--no-border-mask", self.no_border_mask && contrast),
            ("--blur", self.blur.is_some() && distance),
        ];
        match ignored.iter().find(|(_, ignored)| *ignored) {
            Some((option, _)) => {
                Err(format!("{option} has no effect on this observation model: leave it out"))
            }
            None => Ok(()),
        }
    }

    fn config(&self) -> TagConfig {
        let mut config = TagConfig::new(self.observation.into());
        let observation = &mut config.observation;
        observation.blur_sigma_px = self.blur.unwrap_or(observation.blur_sigma_px);
        observation.alpha = self.alpha.unwrap_or(observation.alpha);
        observation.mask_border = !self.no_border_mask;
        config.filter.particles = self.particles as usize;
        config.filter.iterations = self.iterations;
        config.filter.resampling = self.resampling.into();
        config.filter.estimator = self.estimator.into();
        config.filter.seed = self.seed;
        config.filter.adaptive = self.adaptive.then(KldConfig::default);
        config.odometry = !self.no_odometry;
        config.recovery = !self.no_recovery;
        config.refine |= self.smooth;
        config
    }

    /// The sequence as the options want it: other camera, other field, fewer frames, another start.
    fn open_sequence(&self) -> anyhow::Result<Sequence> {
        let mut sequence = Sequence::open(&self.sequence)?;
        if let Some(camera) = &self.camera {
            sequence.setup = read_camera(camera)?;
        }
        if let Some(field) = &self.field {
            sequence.field = field_by_name(field)?;
        }
        let range = self.range(&sequence)?;
        sequence.start = match (self.start, self.unknown_start) {
            (Some(start), _) => Some(start),
            (None, true) => None,
            (None, false) => self.start_at(&sequence, range.start),
        };
        sequence.frames = sequence.frames[range.clone()].to_vec();
        sequence.groundtruth = sequence.groundtruth[range].to_vec();
        Ok(sequence)
    }

    fn range(&self, sequence: &Sequence) -> anyhow::Result<Range<usize>> {
        let count = sequence.frames.len();
        let Some(FrameRange { first, end }) = self.frames else { return Ok(0..count) };
        let end = end.unwrap_or(count);
        if first >= end || end > count {
            let folder = sequence.folder.display();
            bail!("{folder}: has {count} frames: --frames must lie in 0..{count}");
        }
        Ok(first..end)
    }

    /// The pose of a frame from the sequence's start and its odometry; `None` where they do not tell.
    fn start_at(&self, sequence: &Sequence, frame: usize) -> Option<Pose2> {
        let start = sequence.start?;
        if frame == 0 {
            return Some(start);
        }
        let odometry: Option<Vec<Pose2>> =
            sequence.frames[..=frame].iter().map(|record| record.odometry).collect();
        let odometry = odometry.filter(|_| !self.no_odometry)?;
        let reset = odometry.windows(2).any(|pair| {
            pair[1] == Pose2::default() && pair[0].motion_to(pair[1]).distance_m() > RESET_JUMP_M
        });
        (!reset).then(|| start.moved(odometry[0].motion_to(odometry[frame])))
    }

    fn inputs(&self, sequence: &Sequence) -> anyhow::Result<Vec<PathBuf>> {
        let mut inputs = sequence_files(&sequence.folder)?;
        inputs.extend(sequence.frames.iter().map(|frame| sequence.folder.join(&frame.image)));
        inputs.extend([&self.camera, &self.field].into_iter().flatten().cloned());
        Ok(inputs)
    }
}

/// A preset, or a field file.
fn field_by_name(name: &Path) -> anyhow::Result<FieldDimensions> {
    if let Some(field) = name.to_str().and_then(FieldDimensions::preset) {
        return Ok(field);
    }
    if !name.exists() {
        let presets: Vec<&str> = preset_names().collect();
        let (name, presets) = (name.display(), presets.join(", "));
        bail!("{name}: there is no such field preset or file: give a field.toml, or one of {presets}");
    }
    Ok(read_field(name)?)
}

/// The text files of a sequence that could be opened.
fn sequence_files(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let path = folder.join("sequence.toml");
    let table: toml::Table = fs::read_to_string(&path)
        .map_err(anyhow::Error::from)
        .and_then(|text| Ok(toml::from_str(&text)?))
        .with_context(|| format!("{}: cannot be read again", path.display()))?;
    let names =
        ["camera", "field", "frames", "groundtruth"].into_iter().filter_map(|key| table.get(key)?.as_str());
    Ok(names.map(|name| folder.join(name)).chain([path.clone()]).collect())
}

/// Runs the command.
pub fn run(args: &TagArgs) -> anyhow::Result<()> {
    if args.backend == Backend::Gpu {
        bail!("--backend gpu: this build has no GPU support: use --backend cpu");
    }
    let sequence = args.open_sequence()?;
    check_outputs(args, &sequence)?;

    let config = args.config();
    let mut tagger = Tagger::new(&sequence.setup.camera, &sequence.field, sequence.start, config);
    let progress = frame_progress(sequence.frames.len())?;
    let mut path = Vec::new();
    let first = args.frames.map_or(0, |range| range.first);
    let tagged = tag_sequence(&sequence, &mut tagger, |index, frame, picture, tagger| {
        progress.inc(1);
        if let Some(truth) = sequence.groundtruth[index] {
            let error_cm = 100.0 * PoseError::new(frame.pose, truth).distance_m;
            progress.set_message(format!("{error_cm:.1} cm off"));
        }
        match &args.overlay {
            Some(folder) => {
                path.push(frame.pose);
                let file = folder.join(format!("{:06}.jpg", first + index));
                save_image(&file, &draw(&sequence, index, frame, picture, tagger, &path))
            }
            None => Ok(()),
        }
    })
    .inspect_err(|_| progress.finish_and_clear())?;
    progress.finish_and_clear();

    let results = if args.smooth { smoothed(&sequence, &tagger, &tagged)? } else { filtered(&tagged) };
    let poses: Vec<CameraPose> = results.iter().map(|result| result.pose).collect();
    if let Some(details) = &args.details {
        write_atomically(details, details_csv(&sequence, &tagged, &results).as_bytes())?;
    }
    if let Some(out) = &args.out {
        let stamped = sequence.frames.iter().zip(&poses);
        let stamped: Vec<StampedPose> = stamped
            .map(|(frame, pose)| StampedPose { timestamp_s: frame.timestamp_s, pose: *pose })
            .collect();
        write_tum(out, &stamped)?;
    }
    let report = Report::new(args, &sequence, &config, &tagged, &poses);
    if args.json { print_json(&report) } else { print(&report.text(&sequence.name)) }
}

/// A pose to hand out, with what is known of its errors.
struct PoseResult {
    pose: CameraPose,
    /// Standard deviations of x, y, yaw, height, pitch and roll, metres and radians.
    sigmas: Option<[f64; 6]>,
}

/// Every picture's pose as it was found when the picture came.
fn filtered(tagged: &[TaggedFrame]) -> Vec<PoseResult> {
    let sigmas = |frame: &TaggedFrame| frame.fit.map(|fit| fit.covariance.diagonal().map(f64::sqrt).into());
    tagged.iter().map(|frame| PoseResult { pose: frame.pose, sigmas: sigmas(frame) }).collect()
}

/// The most probable poses of the whole recording.
fn smoothed(sequence: &Sequence, tagger: &Tagger, tagged: &[TaggedFrame]) -> anyhow::Result<Vec<PoseResult>> {
    let Some(smoothed) = smooth_sequence(sequence, tagger, tagged)? else {
        bail!(
            "{}: no picture shows enough of the lines to smooth the poses: tag without --smooth",
            sequence.folder.display()
        );
    };
    let result = |pose: &SmoothedPose| PoseResult {
        pose: pose.pose,
        sigmas: Some(pose.covariance.diagonal().map(f64::sqrt).into()),
    };
    Ok(smoothed.iter().map(result).collect())
}

/// Whoever waited for an hour must not learn then that the result has no place.
fn check_outputs(args: &TagArgs, sequence: &Sequence) -> anyhow::Result<()> {
    let inputs = args.inputs(sequence)?;
    for output in [&args.out, &args.details].into_iter().flatten() {
        check_output_file(output, &inputs)?;
    }
    if let (Some(out), Some(details)) = (&args.out, &args.details)
        && out == details
    {
        bail!("{}: is given for --out and for --details: give two names", out.display());
    }
    args.overlay.as_ref().map_or(Ok(()), |folder| create_output_folder(folder, &inputs))
}

fn draw(
    sequence: &Sequence,
    index: usize,
    frame: &TaggedFrame,
    picture: &RgbImage,
    tagger: &Tagger,
    path: &[CameraPose],
) -> RgbImage {
    let attitude = recorded(sequence, index, picture).attitude;
    let border = tagger.border(picture, attitude);
    let overlay = Overlay {
        camera: &sequence.setup.camera,
        field: &sequence.field,
        pose: frame.pose,
        truth: sequence.groundtruth[index],
        border: Some(BorderOutline {
            corners_in_heading: &border.outline_in_heading,
            camera_in_heading: attitude.at(Pose2::default()),
        }),
        particles: tagger.particles(),
        path,
    };
    overlay.draw(picture.clone())
}

/// One line a picture; what is not known is empty.
fn details_csv(sequence: &Sequence, tagged: &[TaggedFrame], results: &[PoseResult]) -> String {
    const DEGREES_OF_FREEDOM: [&str; 6] = ["x_m", "y_m", "yaw_rad", "height_m", "pitch_rad", "roll_rad"];
    let mut csv = String::from("timestamp_s");
    let sigmas = DEGREES_OF_FREEDOM.map(|name| format!("sigma_{name}"));
    for name in DEGREES_OF_FREEDOM.into_iter().chain(sigmas.iter().map(String::as_str)) {
        csv.push(',');
        csv.push_str(name);
    }
    csv.push_str(
        ",effective_sample_size,particles,line_fraction,sure,mirror_probability,searched,error_m,error_yaw_rad\n",
    );
    for (index, (frame, result)) in tagged.iter().zip(results).enumerate() {
        let pose = result.pose;
        // Writing into a string cannot fail.
        let _ = write!(csv, "{}", sequence.frames[index].timestamp_s);
        for value in [pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m, pose.pitch_rad, pose.roll_rad] {
            let _ = write!(csv, ",{value}");
        }
        for axis in 0..DEGREES_OF_FREEDOM.len() {
            csv.push(',');
            if let Some(sigmas) = &result.sigmas {
                let _ = write!(csv, "{}", sigmas[axis]);
            }
        }
        let _ = write!(
            csv,
            ",{},{},{},{},{},{}",
            frame.filter.effective_sample_size,
            frame.filter.particles,
            frame.line_fraction,
            frame.sure,
            frame.mirror_probability,
            frame.searched
        );
        let _ = match sequence.groundtruth[index].map(|truth| PoseError::new(pose, truth)) {
            Some(error) => writeln!(csv, ",{},{}", error.distance_m, error.yaw_rad),
            None => writeln!(csv, ",,"),
        };
    }
    csv
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    sequence: String,
    frames: usize,
    observation: ObservationKind,
    backend: &'static str,
    particles: usize,
    iterations: u32,
    resampling: Resampling,
    estimator: Estimator,
    adaptive: bool,
    seed: u64,
    smoothed: bool,
    /// Median; decoding, drawing and writing excluded.
    seconds_per_frame: f64,
    sure_frames: usize,
    searched_frames: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<ErrorStatistics>,
    out: Option<String>,
    details: Option<String>,
    overlay: Option<String>,
}

impl Report {
    fn new(
        args: &TagArgs,
        sequence: &Sequence,
        config: &TagConfig,
        tagged: &[TaggedFrame],
        poses: &[CameraPose],
    ) -> Self {
        let truths = sequence.groundtruth.iter().zip(poses);
        let errors: Vec<PoseError> =
            truths.filter_map(|(truth, pose)| Some(PoseError::new(*pose, (*truth)?))).collect();
        let mut seconds: Vec<f64> = tagged.iter().map(|frame| frame.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        Self {
            sequence: shown(&args.sequence),
            frames: tagged.len(),
            observation: config.observation.kind,
            backend: "cpu",
            particles: config.filter.particles,
            iterations: config.filter.iterations,
            resampling: config.filter.resampling,
            estimator: config.filter.estimator,
            adaptive: config.filter.adaptive.is_some(),
            seed: config.filter.seed,
            smoothed: args.smooth,
            seconds_per_frame: percentile(&seconds, 0.5).unwrap_or(0.0),
            sure_frames: tagged.iter().filter(|frame| frame.sure).count(),
            searched_frames: tagged.iter().filter(|frame| frame.searched).count(),
            error: ErrorStatistics::new(&errors),
            out: args.out.as_deref().map(shown),
            details: args.details.as_deref().map(shown),
            overlay: args.overlay.as_deref().map(shown),
        }
    }

    /// The same for people.
    fn text(&self, name: &str) -> String {
        let observation = match self.observation {
            ObservationKind::Gauss => "gauss",
            ObservationKind::Distance => "distance",
            ObservationKind::Contrast => "contrast",
        };
        let mut lines = vec![
            ("sequence", format!("{name}, {} frames", self.frames)),
            (
                "model",
                format!(
                    "{observation}, {} particles, {} iterations, {}",
                    self.particles, self.iterations, self.backend
                ),
            ),
            ("time", format!("{:.1} ms a frame (median)", 1e3 * self.seconds_per_frame)),
            ("sure", format!("{} frames; {} searched", self.sure_frames, self.searched_frames)),
        ];
        if let Some(error) = &self.error {
            let cm = |metres: f64| format!("{:.2} cm", 100.0 * metres);
            let [mean, median, p95, max] = [error.mean_m, error.median_m, error.p95_m, error.max_m].map(cm);
            lines.push(("error", format!("mean {mean}, median {median}, 95 % below {p95}, largest {max}")));
            let yaw = error.mean_yaw_rad.to_degrees();
            lines.push(("", format!("yaw {yaw:.2}° in the mean; {} frames lost", error.lost_frames)));
        }
        for (name, path) in [("poses", &self.out), ("details", &self.details), ("overlay", &self.overlay)] {
            lines.extend(path.iter().map(|path| (name, path.clone())));
        }
        lines.iter().map(|(name, value)| format!("{name:10}{value}\n")).collect()
    }
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_half_open_and_may_be_open() {
        let range = |first, end| Ok(FrameRange { first, end });
        assert_eq!(frame_range("3..8"), range(3, Some(8)));
        assert_eq!(frame_range("3.."), range(3, None));
        assert_eq!(frame_range("..8"), range(0, Some(8)));
        for wrong in ["", "5", "8..3", "3..3", "-1..4", "a..b", "1..2..3"] {
            assert!(frame_range(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_start_is_three_finite_numbers() {
        assert_eq!(start_pose("-1.5, 2,0.25"), Ok(Pose2::new(-1.5, 2.0, 0.25)));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,x", "NaN,0,0", "inf,0,0"] {
            assert!(start_pose(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert_eq!(blur_px("1.5"), Ok(1.5));
        assert!(["-1", "51", "NaN", "x"].iter().all(|text| blur_px(text).is_err()));
        assert_eq!(positive("1e3"), Ok(1e3));
        assert!(["0", "-1", "inf", "NaN", "x"].iter().all(|text| positive(text).is_err()));
    }
}
