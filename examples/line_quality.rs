//! What JaC@5 and JaC@10 are worth: measures them at the reference poses of recordings, and at poses and focal lengths that are wrong by
//! a known amount. The thresholds of `reality_sim::quality` come from its tables.
//! `cargo run --release --example line_quality -- assets/walk assets/pitch`; with `FOLDER@10` only every tenth picture.

#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use std::{
    env,
    error::Error,
    f64::consts::{PI, TAU},
    path::Path,
    time::Instant,
};

use reality_sim::{
    CameraPose, Sequence,
    localization::mount_of_frame,
    preprocess::{LinePoints, Preprocessor},
    quality::{LineMeter, RecordingQuality},
};

/// Golden angle, radians: directions that are spread evenly, however many there are.
const GOLDEN_RAD: f64 = 2.399_963_229_728_653;

/// Picture with its lines and its reference pose.
struct Seen {
    points: LinePoints,
    pose: CameraPose,
}

fn main() -> Result<(), Box<dyn Error>> {
    for argument in env::args().skip(1) {
        let (folder, every) = argument.split_once('@').unwrap_or((&argument, "1"));
        let sequence = Sequence::open(Path::new(folder))?;
        let pictures = see(&sequence, every.parse()?)?;
        println!("{folder}: {} pictures", pictures.len());
        measure_all(&sequence, &pictures);
    }
    Ok(())
}

fn see(sequence: &Sequence, every: usize) -> Result<Vec<Seen>, Box<dyn Error>> {
    let preprocessor = Preprocessor::new(&sequence.setup.camera, sequence.field.line_width_m);
    let mut pictures = Vec::new();
    let mut seconds = 0.0;
    for (index, frame) in sequence.frames.iter().enumerate().step_by(every.max(1)) {
        let Some(pose) = frame.reference_pose else { continue };
        let prepared = preprocessor.prepare(sequence.load_image(index)?, mount_of_frame(sequence, index));
        let begin = Instant::now();
        let points = prepared.line_points();
        seconds += begin.elapsed().as_secs_f64();
        pictures.push(Seen { points, pose });
    }
    println!("  finding lines: {:.2} ms a picture", 1e3 * seconds / pictures.len().max(1) as f64);
    Ok(pictures)
}

fn measure_all(sequence: &Sequence, pictures: &[Seen]) {
    let meter = LineMeter::new(&sequence.setup.camera, &sequence.field);
    let row = |name: String, wrong: &dyn Fn(usize, CameraPose) -> CameraPose| {
        print_row(&name, &meter, pictures, wrong);
    };
    row("right poses".to_owned(), &|_, pose| pose);
    for off_m in [0.02, 0.05, 0.1, 0.2] {
        row(format!("{:.0} cm off", 100.0 * off_m), &|index, pose| {
            let (sin, cos) = (GOLDEN_RAD * index as f64).sin_cos();
            CameraPose { x_m: pose.x_m + off_m * cos, y_m: pose.y_m + off_m * sin, ..pose }
        });
    }
    for degrees in [1.0_f64, 2.0, 5.0] {
        let turn = |index: usize| if index.is_multiple_of(2) { degrees } else { -degrees }.to_radians();
        row(format!("yaw {degrees}° off"), &|index, pose| CameraPose {
            yaw_rad: pose.yaw_rad + turn(index),
            ..pose
        });
        row(format!("pitch {degrees}° off"), &|index, pose| CameraPose {
            pitch_rad: pose.pitch_rad + turn(index),
            ..pose
        });
    }
    row("mirror poses".to_owned(), &|_, pose| pose.mirrored());
    row("lost".to_owned(), &|index, pose| CameraPose {
        x_m: 0.5 * sequence.field.length_m * (GOLDEN_RAD * index as f64).cos(),
        y_m: 0.5 * sequence.field.width_m * (1.7 * GOLDEN_RAD * index as f64).sin(),
        yaw_rad: (GOLDEN_RAD * index as f64 * 0.31) % TAU - PI,
        ..pose
    });
    for percent in [0.5, 2.0] {
        let mut camera = sequence.setup.camera.clone();
        camera.fx *= 1.0 + 0.01 * percent;
        camera.fy *= 1.0 + 0.01 * percent;
        let meter = LineMeter::new(&camera, &sequence.field);
        print_row(&format!("focal length {percent} % off"), &meter, pictures, &|_, pose| pose);
    }
}

fn print_row(
    name: &str,
    meter: &LineMeter,
    pictures: &[Seen],
    wrong: &dyn Fn(usize, CameraPose) -> CameraPose,
) {
    let begin = Instant::now();
    let measured: Vec<_> = pictures
        .iter()
        .enumerate()
        .map(|(index, seen)| (meter.measure(&seen.points, wrong(index, seen.pose)), true))
        .collect();
    let count = pictures.len().max(1) as f64;
    let ms = 1e3 * begin.elapsed().as_secs_f64() / count;
    let quality = RecordingQuality::new(measured.iter().copied());
    let mean = |of: &dyn Fn(usize) -> u32| f64::from((0..measured.len()).map(of).sum::<u32>()) / count;
    println!(
        "  {name:<23} JaC@5 {:.2}, JaC@10 {:.2}; a picture: {:.2} seen, {:.2} unseen, {:.2} unexplained; {ms:.2} ms; {:?}",
        quality.lines_within_5px,
        quality.lines_within_10px,
        mean(&|index| measured[index].0.seen),
        mean(&|index| measured[index].0.unseen),
        mean(&|index| measured[index].0.unexplained),
        quality.verdict(),
    );
}
