//! A small closed loop: a robot follows a line of the field by its camera, whose pictures are made from recorded ones.
//! `cargo run --release --example simulator`, or with a database, a start pose and a folder for the pictures: `… --example
//! simulator -- walk.db -2.25,-0.45,1.45 pictures`.

#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use std::{env, error::Error, path::Path, sync::Arc};

use glam::DVec2;
use image::RgbImage;
use reality_sim::{
    Archive, CameraPose, Pose2, Sequence, Synthesizer,
    camera::Camera,
    db::{Database, PoseEstimate, PoseSource},
    pose::Motion2,
    sequence::save_image,
    synthesis::Auto,
};

const STEPS: usize = 24;
const STEP_M: f64 = 0.05;
/// Place where the robot searches for the line: distance ahead, and to both sides.
const AHEAD_M: f64 = 0.7;
const ASIDE_M: f64 = 0.4;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let file = env::temp_dir().join(format!("reality-sim-example-{}.db", std::process::id()));
    let database = match arguments.first() {
        Some(database) => Path::new(database),
        None => demonstration(&file)?,
    };
    let start = arguments.get(1).map_or("-2.25,-0.45,1.45", String::as_str);
    let numbers: Vec<f64> = start.split(',').map(str::parse).collect::<Result<_, _>>()?;
    let &[x_m, y_m, yaw_rad] = numbers.as_slice() else { return Err("the start is X,Y,YAW".into()) };

    let archive = Arc::new(Archive::open(database, 256 << 20)?);
    let usual = archive.usual_pose();
    let simulator = Synthesizer::new(archive);
    let mut robot = Pose2::new(x_m, y_m, yaw_rad);
    for step in 0..STEPS {
        let seen = simulator.image_at(usual.with_planar(robot), &Auto)?;
        let line_m = line_to_the_left(&seen.picture, simulator.camera(), usual);
        let turn_rad = line_m.map_or(0.0, |left_m| left_m.atan2(AHEAD_M).clamp(-0.15, 0.15));
        println!(
            "{step:2}: {:6.2} m {:6.2} m {:4.0}°, line {:>5} cm to the left, {:3.0} % recorded",
            robot.x_m,
            robot.y_m,
            robot.yaw_rad.to_degrees(),
            line_m.map_or("?".to_owned(), |left_m| format!("{:.0}", 100.0 * left_m)),
            100.0 * seen.covered(),
        );
        if let Some(folder) = arguments.get(2) {
            save_image(&Path::new(folder).join(format!("{step:06}.png")), &seen.picture)?;
        }
        robot = robot.moved(Motion2 { forward_m: STEP_M, left_m: 0.0, turn_rad });
    }
    std::fs::remove_file(file).ok();
    Ok(())
}

/// Returns the centre of the white pixels on the ground ahead, metres to the left.
fn line_to_the_left(picture: &RgbImage, camera: &Camera, usual: CameraPose) -> Option<f64> {
    let eye = usual.with_planar(Pose2::default());
    let (mut sum, mut total) = (0.0, 0.0);
    for centimetre in -40..=40 {
        let left_m = ASIDE_M * f64::from(centimetre) / 40.0;
        let Ok(pixel) = camera.project(eye.camera_from_world(DVec2::new(AHEAD_M, left_m).extend(0.0))) else {
            continue;
        };
        let [red, green, blue] = picture.get_pixel(pixel.x.round() as u32, pixel.y.round() as u32).0;
        let white = f64::from(red.min(green).min(blue).saturating_sub(150));
        sum += white * left_m;
        total += white;
    }
    (total > 0.0).then(|| sum / total)
}

/// Builds a database of the walk that comes with the project.
fn demonstration(path: &Path) -> Result<&Path, Box<dyn Error>> {
    let walk = Sequence::open(Path::new("assets/walk"))?;
    let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    Database::create_or_open(path)?.ingest(&walk, &poses, &PoseSource::GroundTruth)?;
    Ok(path)
}
