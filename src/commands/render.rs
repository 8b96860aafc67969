//! `reality-sim render`: the picture at a pose, or those along a path.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use image::{DynamicImage, RgbImage};
use serde::Serialize;

use reality_sim::{
    Archive, CameraPose, Pose2, Reconstruction, Synthesizer,
    montage::strip,
    sensor::{Renderer, SceneColors},
    sequence::{read_camera, read_tum, save_image},
    synthesis::{Auto, Blend, Method, Nearest, Plane, Quadratic},
};

use super::{
    output::{check_distinct, check_output_picture, create_output_folder, frame_progress, print, print_json},
    picture_at::SynthesisArgs,
};

/// Pictures of a path in its strip.
const STRIP_PICTURES: usize = 8;

/// Options of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The database, as `build` makes it
    database: PathBuf,
    /// The camera's pose: metres, metres, radians, metres, radians, radians [default of the last three: as the camera
    /// usually has them in the database]
    #[arg(long, value_name = "X,Y,YAW[,HEIGHT,PITCH,ROLL]", value_parser = wanted_pose, allow_hyphen_values = true)]
    pose: Option<WantedPose>,
    /// All poses of a TUM file: --out is then a folder
    #[arg(long, value_name = "FILE", conflicts_with = "pose", required_unless_present = "pose")]
    path: Option<PathBuf>,
    /// The way to the picture
    #[arg(long, value_enum, default_value = "auto")]
    method: MethodName,
    /// The picture, PNG or JPEG; with --path the folder of the pictures
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Where the picture came from: a colour for each picture used, the brighter the more it can be trusted
    #[arg(long, value_name = "FILE", requires = "pose")]
    origins: Option<PathBuf>,
    /// How far each pixel can be trusted: white fully, black not at all
    #[arg(long, value_name = "FILE", requires = "pose")]
    trust: Option<PathBuf>,
    /// Some pictures of the path side by side
    #[arg(long, value_name = "FILE", requires = "path")]
    strip: Option<PathBuf>,
    /// Draw as this camera sees, not as the one that took the pictures
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    #[command(flatten)]
    synthesis: SynthesisArgs,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// The ways to a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// The picture recorded at the pose where there is one, else as blend
    Auto,
    /// The nearest picture as it is
    Nearest,
    /// The paper's Eq. 4: a polynomial of second order from the nearest picture
    Quadratic,
    /// One picture, through the ground plane and both lenses
    Plane,
    /// Several pictures, mixed pixel by pixel
    Blend,
    /// No picture: the model of the field, drawn
    Simulated,
}

/// A pose, of which the last three numbers may be left open.
#[derive(Debug, Clone, Copy, PartialEq)]
struct WantedPose {
    planar: Pose2,
    attitude: Option<[f64; 3]>,
}

fn wanted_pose(text: &str) -> Result<WantedPose, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|number| number.is_finite()));
    match numbers.as_deref() {
        Some(&[x_m, y_m, yaw_rad]) => {
            Ok(WantedPose { planar: Pose2::new(x_m, y_m, yaw_rad), attitude: None })
        }
        Some(&[x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad]) => Ok(WantedPose {
            planar: Pose2::new(x_m, y_m, yaw_rad),
            attitude: Some([height_m, pitch_rad, roll_rad]),
        }),
        _ => {
            Err("give three or six finite numbers: metres, metres, radians, metres, radians, radians"
                .to_owned())
        }
    }
}

#[derive(Serialize)]
struct Report {
    method: &'static str,
    pictures: usize,
    /// Of one picture with its neighbours decoded; along a path the median, decoding included. Writing is not.
    milliseconds: f64,
    /// Share of the pixels that some recorded picture shows: the mean over the pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    covered: Option<f64>,
    /// Pictures that a single picture was made from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    used: Vec<UsedReport>,
    out: String,
}

#[derive(Serialize)]
struct UsedReport {
    sequence: String,
    frame: usize,
    distance_px: f64,
    share: f64,
}

/// What draws.
enum Painter<'a> {
    Recorded(&'a Synthesizer, &'static dyn Method),
    Simulated(Box<Renderer>),
}

/// A picture.
struct Painted {
    work: Work,
    milliseconds: f64,
}

/// With where it came from, or without.
enum Work {
    Reconstructed(Reconstruction),
    Drawn(RgbImage),
}

impl Work {
    fn picture(&self) -> &RgbImage {
        match self {
            Self::Reconstructed(reconstruction) => &reconstruction.picture,
            Self::Drawn(picture) => picture,
        }
    }

    fn covered(&self) -> Option<f64> {
        match self {
            Self::Reconstructed(reconstruction) => Some(reconstruction.covered()),
            Self::Drawn(_) => None,
        }
    }
}

impl Painter<'_> {
    fn paint(&self, pose: CameraPose) -> anyhow::Result<Painted> {
        let start = Instant::now();
        let work = match self {
            Self::Recorded(synthesizer, method) => Work::Reconstructed(synthesizer.image_at(pose, *method)?),
            Self::Simulated(renderer) => Work::Drawn(renderer.draw(pose)?),
        };
        Ok(Painted { work, milliseconds: 1e3 * start.elapsed().as_secs_f64() })
    }
}

impl RenderArgs {
    /// Refuses options that contradict each other.
    pub fn check_usage(&self) -> Result<(), String> {
        let wants_origins = self.origins.is_some() || self.trust.is_some();
        if self.method == MethodName::Simulated && wants_origins {
            return Err("--origins, --trust: a simulated picture comes from no recorded one: leave them out"
                .to_owned());
        }
        self.synthesis.backend.check_usage()
    }
}

/// Runs the command.
pub fn run(args: &RenderArgs) -> anyhow::Result<()> {
    let archive = args.synthesis.archive(&args.database)?;
    let poses = poses(args, &archive)?;
    check_outputs(args)?;
    let camera = args.camera.as_ref().map(|file| read_camera(file)).transpose()?;
    let mut setup = archive.setup().clone();
    if let Some(given) = &camera {
        setup.camera = given.camera.clone();
    }
    let synthesizer = args.synthesis.synthesizer(archive.clone(), camera.map(|setup| setup.camera))?;
    let painter = match args.method {
        MethodName::Auto => Painter::Recorded(&synthesizer, &Auto),
        MethodName::Nearest => Painter::Recorded(&synthesizer, &Nearest),
        MethodName::Quadratic => Painter::Recorded(&synthesizer, &Quadratic),
        MethodName::Plane => Painter::Recorded(&synthesizer, &Plane),
        MethodName::Blend => Painter::Recorded(&synthesizer, &Blend),
        MethodName::Simulated => {
            let colors = SceneColors::new(&setup, archive.field());
            Painter::Simulated(Box::new(Renderer::new(&setup, archive.field(), colors)))
        }
    };
    let report = match &args.path {
        Some(path) => along_path(args, path, &painter, &poses)?,
        None => at_pose(args, &painter, &archive, poses[0])?,
    };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

fn poses(args: &RenderArgs, archive: &Archive) -> anyhow::Result<Vec<CameraPose>> {
    let usual = archive.usual_pose();
    match (&args.pose, &args.path) {
        (Some(WantedPose { planar, attitude }), _) => {
            let [height_m, pitch_rad, roll_rad] =
                attitude.unwrap_or([usual.height_m, usual.pitch_rad, usual.roll_rad]);
            Ok(vec![CameraPose::new(*planar, height_m, pitch_rad, roll_rad)])
        }
        (None, Some(file)) => {
            let poses: Vec<CameraPose> = read_tum(file)?.iter().map(|stamped| stamped.pose).collect();
            if poses.is_empty() {
                bail!("{}: holds no poses: give a TUM file with one pose a line", file.display());
            }
            Ok(poses)
        }
        // The options require one of the two.
        (None, None) => bail!("give --pose or --path"),
    }
}

fn check_outputs(args: &RenderArgs) -> anyhow::Result<()> {
    let inputs: Vec<PathBuf> = [Some(&args.database), args.path.as_ref(), args.camera.as_ref()]
        .into_iter()
        .flatten()
        .cloned()
        .collect();
    let beside = [&args.origins, &args.trust, &args.strip].into_iter().flatten();
    check_distinct(&std::iter::once(&args.out).chain(beside.clone()).collect::<Vec<_>>())?;
    beside.clone().try_for_each(|output| check_output_picture(output, &inputs))?;
    match args.path {
        Some(_) => {
            create_output_folder(&args.out, &inputs)?;
            let inside = args.strip.as_ref().filter(|strip| strip.parent() == Some(&args.out));
            inside.map_or(Ok(()), |strip| {
                bail!("{}: lies among the pictures of the path: give another folder", strip.display())
            })
        }
        None => check_output_picture(&args.out, &inputs),
    }
}

fn at_pose(
    args: &RenderArgs,
    painter: &Painter,
    archive: &Archive,
    pose: CameraPose,
) -> anyhow::Result<Report> {
    painter.paint(pose)?;
    // Once more, for the time that it takes when the neighbours are decoded.
    let Painted { work, milliseconds } = painter.paint(pose)?;
    save_image(&args.out, work.picture())?;
    let mut report = Report {
        method: args.method.name(),
        pictures: 1,
        milliseconds,
        covered: None,
        used: Vec::new(),
        out: args.out.display().to_string(),
    };
    if let Work::Reconstructed(reconstruction) = work {
        if let Some(file) = &args.origins {
            save_image(file, &reconstruction.origin_picture())?;
        }
        if let Some(file) = &args.trust {
            save_image(file, &DynamicImage::from(reconstruction.trust_picture()).into_rgb8())?;
        }
        report.method = reconstruction.method;
        report.covered = Some(reconstruction.covered());
        report.used = used(archive, &reconstruction)?;
    }
    Ok(report)
}

fn used(archive: &Archive, reconstruction: &Reconstruction) -> anyhow::Result<Vec<UsedReport>> {
    let names = archive.database().sequences()?;
    let report = |used: &reality_sim::synthesis::Used| {
        let record = &archive.images()[used.image as usize];
        UsedReport {
            sequence: names.get(&record.sequence_id).cloned().unwrap_or_default(),
            frame: record.frame_index,
            distance_px: used.distance_px,
            share: used.share,
        }
    };
    Ok(reconstruction.used.iter().map(report).collect())
}

fn along_path(
    args: &RenderArgs,
    path: &Path,
    painter: &Painter,
    poses: &[CameraPose],
) -> anyhow::Result<Report> {
    let progress = frame_progress(poses.len())?;
    let mut times = Vec::new();
    let mut covered = Vec::new();
    let mut shown = Vec::new();
    for (index, &pose) in poses.iter().enumerate() {
        let painted = painter.paint(pose).inspect_err(|_| progress.finish_and_clear());
        let Painted { work, milliseconds } =
            painted.with_context(|| format!("{}, pose {}", path.display(), index + 1))?;
        save_image(&args.out.join(format!("{index:06}.png")), work.picture())?;
        times.push(milliseconds);
        covered.extend(work.covered());
        if is_in_strip(index, poses.len()) {
            shown.push(work.picture().clone());
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if let Some(file) = &args.strip {
        save_image(file, &strip(&shown))?;
    }
    times.sort_by(f64::total_cmp);
    Ok(Report {
        method: args.method.name(),
        pictures: poses.len(),
        milliseconds: times[times.len() / 2],
        covered: (!covered.is_empty()).then(|| covered.iter().sum::<f64>() / covered.len() as f64),
        used: Vec::new(),
        out: args.out.display().to_string(),
    })
}

/// Whether a picture is one of those evenly spread over the path.
fn is_in_strip(index: usize, count: usize) -> bool {
    let shown = count.min(STRIP_PICTURES);
    (0..shown).any(|i| i * (count - 1) / (shown - 1).max(1) == index)
}

impl MethodName {
    fn name(self) -> &'static str {
        match self {
            Self::Auto => Auto.name(),
            Self::Nearest => Nearest.name(),
            Self::Quadratic => Quadratic.name(),
            Self::Plane => Plane.name(),
            Self::Blend => Blend.name(),
            Self::Simulated => "simulated",
        }
    }
}

impl Report {
    fn text(&self) -> String {
        let mut lines = vec![("method", self.method.to_owned())];
        if self.pictures > 1 {
            lines.push(("pictures", self.pictures.to_string()));
        }
        for used in &self.used {
            let UsedReport { sequence, frame, distance_px, share } = used;
            let percent = 100.0 * share;
            lines.push((
                "from",
                format!("{sequence} frame {frame}, {distance_px:.0} px away, {percent:.0} % of the pixels"),
            ));
        }
        if let Some(covered) = self.covered {
            lines.push(("recorded", format!("{:.0} % of the pixels; the rest is filled", 100.0 * covered)));
        }
        lines.push(("time", format!("{:.1} ms a picture", self.milliseconds)));
        lines.push(("picture", self.out.clone()));
        lines.iter().map(|(name, value)| format!("{name:10}{value}\n")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_is_three_or_six_finite_numbers() {
        let planar = Pose2::new(-1.0, 0.5, 2.0);
        assert_eq!(wanted_pose("-1, 0.5,2"), Ok(WantedPose { planar, attitude: None }));
        let whole = WantedPose { planar, attitude: Some([0.5, 0.4, 0.1]) };
        assert_eq!(wanted_pose("-1,0.5,2,0.5,0.4,0.1"), Ok(whole));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,NaN", "1,2,3,4,5,inf", "a,b,c"] {
            assert!(wanted_pose(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_strip_shows_first_and_last_and_no_more_than_fit() {
        for count in 1..40 {
            let shown: Vec<usize> = (0..count).filter(|&index| is_in_strip(index, count)).collect();
            assert_eq!(shown.len(), count.min(STRIP_PICTURES));
            assert_eq!((shown[0], shown[shown.len() - 1]), (0, count - 1));
        }
    }
}
