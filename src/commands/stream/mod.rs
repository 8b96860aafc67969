//! `reality-sim stream`: what a camera sees along a path, as messages of ROS 2.

mod options;

use std::{sync::Arc, time::Instant};

use anyhow::{Context, bail};
use serde::Serialize;

use reality_sim::{
    StampedPose,
    evaluation::percentile,
    sequence::read_tum,
    simulator::{Ball, Camera, Frame, Layer, SeenObject},
};
use reality_sim_formats::ros2::{CameraShot, CameraTopics, ObjectBox, PixelLabels};

pub use self::options::StreamArgs;
use super::{
    model_file::Use,
    output::{aligned, check_output_file, frame_progress, print, print_json},
    receivers::Receivers,
    wanted_ball::WantedBall,
};

/// Report that `--json` prints.
#[derive(Serialize)]
struct Report {
    pictures: usize,
    /// Median time of a picture with its labels, without sending it.
    milliseconds: f64,
    /// What of the model was used.
    #[serde(skip_serializing_if = "Option::is_none")]
    corrections: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<String>,
}

/// Runs the command.
pub fn run(args: &StreamArgs) -> anyhow::Result<()> {
    let model = args.model.read()?;
    let archive = args.synthesis.archive(&args.database, model.as_ref())?;
    let poses = read_tum(&args.path)?;
    if poses.is_empty() {
        bail!("{}: contains no poses: give a TUM file with one pose a line", args.path.display());
    }
    if let Some(out) = &args.out {
        check_output_file(out, &[args.database.clone(), args.path.clone()])?;
    }
    let lens = archive.setup().camera.clone();
    let synthesizer = Arc::new(args.synthesis.synthesizer(archive.clone(), lens)?);
    let mut camera = Camera::with(synthesizer, args.method).with_labels(!args.no_labels);
    if let Some(model) = &model {
        camera = camera.with_model(&model.model).map_err(|error| error.in_file(model.path()))?;
    }
    let milliseconds = send(args, &mut camera, &poses)?;
    let corrected = Use::Pictures { is_corrected: archive.corrected_by().is_some() };
    let report = Report {
        pictures: poses.len(),
        milliseconds,
        corrections: model.map(|model| model.words(archive.setup(), archive.field(), corrected)),
        out: args.out.as_ref().map(|file| file.display().to_string()),
    };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

/// Sends the pictures at all poses. Returns the median time of one.
fn send(args: &StreamArgs, camera: &mut Camera, poses: &[StampedPose]) -> anyhow::Result<f64> {
    let balls: Vec<Ball> = args.ball.iter().map(WantedBall::layer).collect();
    let layers: Vec<&dyn Layer> = balls.iter().map(|ball| ball as &dyn Layer).collect();
    let mut receivers = receivers(args)?;
    let progress = frame_progress(poses.len())?;
    let mut frame = Frame::default();
    let mut times_ms = Vec::new();
    for (index, StampedPose { timestamp_s, pose }) in poses.iter().enumerate() {
        let start = Instant::now();
        camera.set_time_s(*timestamp_s);
        camera
            .look(*pose, &layers, &mut frame)
            .inspect_err(|_| progress.finish_and_clear())
            .with_context(|| format!("{}, pose {}", args.path.display(), index + 1))?;
        let made_ms = 1e3 * start.elapsed().as_secs_f64();
        send_frame(&mut receivers, camera, &frame, *timestamp_s);
        times_ms.push(made_ms);
        progress.inc(1);
    }
    progress.finish_and_clear();
    receivers.finish()?;
    times_ms.sort_by(f64::total_cmp);
    Ok(percentile(&times_ms, 0.5).unwrap_or_default())
}

/// Begins the file and starts the server that the options name.
fn receivers(args: &StreamArgs) -> anyhow::Result<Receivers<CameraTopics>> {
    let receivers = Receivers::of_file(args.out.as_deref())?;
    #[cfg(feature = "live")]
    let receivers = receivers.and_server(&args.serving)?;
    Ok(receivers)
}

fn send_frame(receivers: &mut Receivers<CameraTopics>, camera: &Camera, frame: &Frame, timestamp_s: f64) {
    let labels = &frame.labels;
    let classes = labels.class_picture();
    let is_labelled = !labels.classes.is_empty();
    // Goals come first among the labels' things; without labels, the objects are numbered as with them.
    let things: Vec<(usize, &SeenObject)> = match is_labelled {
        true => labels.things.iter().enumerate().collect(),
        false => frame.objects.iter().enumerate().map(|(place, object)| (place + GOALS, object)).collect(),
    };
    let objects: Vec<ObjectBox<'_>> =
        things.iter().filter_map(|(place, thing)| object_box(*place, thing)).collect();
    receivers.send(&CameraShot {
        timestamp_s,
        camera: camera.synthesizer().camera(),
        pose: frame.pose,
        rgb: frame.picture.as_raw(),
        labels: is_labelled.then_some(PixelLabels {
            classes: classes.as_raw(),
            instances: &labels.instances,
            distance_m: &labels.distance_m,
        }),
        objects: &objects,
    });
}

/// Number of goals, which are the first things of labels.
const GOALS: usize = 2;

/// Returns the box of a thing, if it is seen.
fn object_box(place: usize, thing: &SeenObject) -> Option<ObjectBox<'_>> {
    let area = thing.visible?;
    let instance = u16::try_from(place + 1).ok()?;
    let pixels = [area.left, area.top, area.right, area.bottom];
    Some(ObjectBox { class: thing.class.name(), instance, pixels })
}

impl Report {
    fn text(&self) -> String {
        let mut lines = vec![
            ("pictures", self.pictures.to_string()),
            ("time", format!("{:.1} ms a picture with its labels", self.milliseconds)),
        ];
        lines.extend(self.corrections.iter().map(|corrections| ("camera", corrections.clone())));
        lines.extend(self.out.iter().map(|out| ("messages", out.clone())));
        aligned(&lines)
    }
}
