//! How long a simulator's camera takes for a picture, with and without layers and labels, and how many frames a second it keeps
//! up along a smooth path:
//!
//! `cargo run --release --example camera_speed -- DATABASE PROBES`
//!
//! The poses of the recording PROBES are those of single pictures; the path is beside that of the database's own pictures.
//! Times are of wall clock. `scripts/compare_with_remap` runs this beside OpenCV.

use std::{io::Write, path::PathBuf, sync::Arc, time::Instant};

use anyhow::{Context, bail};
use glam::{DVec2, Vec3};
use reality_sim::{
    Archive, CameraPose, Pose2, Sequence, Synthesizer,
    evaluation::percentile,
    pose::Motion2,
    sensor::Trajectory,
    simulator::{Ball, Camera, Frame, Humanoid, Layer},
    synthesis::{MethodKind, SynthesisConfig},
    warp::CpuWarper,
};

/// Memory for decoded pictures.
const CACHE_BYTES: usize = 256 << 20;
/// Times that each probe is drawn.
const ROUNDS: usize = 8;
/// Frames of the path, and their number in a second of the walk.
const FRAMES: usize = 300;
const FRAMES_A_SECOND: f64 = 30.0;
/// How far the path lies beside that of the recorded pictures.
const BESIDE: Motion2 = Motion2 { forward_m: 0.0, left_m: 0.05, turn_rad: 0.05 };

fn main() -> anyhow::Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [database, probes] = arguments.as_slice() else { bail!("give DATABASE and PROBES") };
    let archive = Arc::new(Archive::open(database, CACHE_BYTES)?);
    let probes = Sequence::open(probes)?;
    let poses: Vec<CameraPose> = probes.reference_poses().flatten().collect();
    let mut out = std::io::stdout().lock();
    for method in [MethodKind::Plane, MethodKind::Blend] {
        let camera = camera(&archive, method);
        writeln!(out, "{method} {:.2} ms", median_ms(camera, &poses, |_| Vec::new())?)?;
    }
    let full = camera(&archive, MethodKind::Blend).with_labels(true);
    writeln!(out, "blend with ball, three robots and labels {:.2} ms", median_ms(full, &poses, things)?)?;
    let path = path(&archive)?;
    for (is_ahead, name) in [(false, "decoding when needed"), (true, "decoding ahead")] {
        // Nothing is decoded before.
        let archive = Arc::new(Archive::open(database, CACHE_BYTES)?);
        let camera = camera(&archive, MethodKind::Blend).with_decoding_ahead(is_ahead);
        let rate = path.len() as f64 / seconds_along(camera, &path)?;
        writeln!(out, "path of {FRAMES} frames, {name}: {rate:.0} frames a second")?;
    }
    writeln!(out, "largest memory {:.0} MB", peak_memory_mb().context("no /proc/self/status")?)?;
    Ok(())
}

/// Makes a camera that sees at every pose.
fn camera(archive: &Arc<Archive>, method: MethodKind) -> Camera {
    let config = SynthesisConfig::new(archive).best_effort();
    let lens = archive.setup().camera.clone();
    let synthesizer = Synthesizer::with(archive.clone(), lens, Arc::new(CpuWarper), config);
    Camera::with(Arc::new(synthesizer), method)
}

/// Returns the median time of a picture whose neighbours are decoded. The camera jumps from pose to pose.
fn median_ms(
    mut camera: Camera,
    poses: &[CameraPose],
    things: impl Fn(CameraPose) -> Vec<Box<dyn Layer>>,
) -> anyhow::Result<f64> {
    let mut frame = Frame::default();
    let mut times_ms = Vec::new();
    for &pose in poses {
        let things = things(pose);
        let layers: Vec<&dyn Layer> = things.iter().map(Box::as_ref).collect();
        camera.look(pose, &layers, &mut frame)?;
        for _ in 0..ROUNDS {
            camera.forget_path();
            let start = Instant::now();
            camera.look(pose, &layers, &mut frame)?;
            times_ms.push(1e3 * start.elapsed().as_secs_f64());
        }
    }
    times_ms.sort_by(f64::total_cmp);
    percentile(&times_ms, 0.5).context("no probes")
}

/// Puts a ball and three robots before a camera.
fn things(pose: CameraPose) -> Vec<Box<dyn Layer>> {
    let at = |forward_m: f64, left_m: f64| {
        pose.planar().moved(Motion2 { forward_m, left_m, turn_rad: 2.0 }).position_in_world()
    };
    let robot = |place: DVec2| -> Box<dyn Layer> {
        Box::new(Humanoid::standing(Pose2::new(place.x, place.y, 1.0), 0.58, Vec3::new(0.1, 0.2, 0.8)))
    };
    let ball = at(1.0, 0.1);
    vec![
        Box::new(Ball::on_ground(ball.x, ball.y, 0.065, Vec3::new(0.9, 0.3, 0.03))),
        robot(at(1.2, -0.4)),
        robot(at(1.8, 0.5)),
        robot(at(2.6, -0.2)),
    ]
}

/// Returns poses beside the path of the pictures in an archive.
fn path(archive: &Archive) -> anyhow::Result<Vec<CameraPose>> {
    let poses: Vec<(f64, CameraPose)> =
        archive.images().iter().map(|image| (image.timestamp_s, image.pose)).collect();
    let start_s = poses.first().context("no images")?.0;
    let trajectory = Trajectory::new(&poses)?;
    let at = |frame: usize| {
        let pose = trajectory.at(start_s + frame as f64 / FRAMES_A_SECOND);
        pose.with_planar(pose.planar().moved(BESIDE))
    };
    Ok((0..FRAMES).map(at).collect())
}

fn seconds_along(mut camera: Camera, path: &[CameraPose]) -> anyhow::Result<f64> {
    let mut frame = Frame::default();
    let start = Instant::now();
    for &pose in path {
        camera.look(pose, &[], &mut frame)?;
    }
    Ok(start.elapsed().as_secs_f64())
}

fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
