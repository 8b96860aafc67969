//! `reality-sim calibrate`, run as users run it, on the demonstration walk, whose camera is known exactly.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{
    fs,
    path::{Path, PathBuf},
};

use glam::DVec2;
use serde_json::Value;
use tempfile::TempDir;

use common::{WALK, assert_fails, program, shown, text};
use reality_sim::{
    Camera, CameraPose, Sequence,
    camera::{Distortion, OpencvFisheye},
    sequence::read_camera,
};

/// Errors of a calibration as real ones have them: focal length (relative), k1, height (metres), pitch (radians).
const OFF: (f64, f64, f64, f64) = (0.005, 0.004, 0.01, 0.0087);

/// Writes the walk with its camera off, or without any camera file, and without start and reference poses.
fn walk(folder: &Path, has_camera: bool) -> PathBuf {
    let mut walk = Sequence::open(Path::new(WALK)).unwrap();
    for frame in 0..walk.frames.len() {
        walk.copy_image(frame, folder).unwrap();
    }
    let camera = walk.setup.camera.clone();
    let mut k = camera.distortion.parameters();
    k[0] += OFF.1;
    let distortion = Distortion::OpencvFisheye(OpencvFisheye { k: [k[0], k[1], k[2], k[3]] });
    let focal = [camera.fx, camera.fy].map(|focal| focal * (1.0 + OFF.0));
    let size = [camera.width, camera.height];
    walk.setup.camera = Camera::new(size, [focal[0], focal[1], camera.cx, camera.cy], distortion).unwrap();
    walk.setup.mount_height_m += OFF.2;
    walk.start = None;
    for frame in &mut walk.frames {
        frame.reference_pose = None;
        if has_camera {
            frame.pitch_rad += OFF.3;
        }
    }
    walk.poses_between_frames.clear();
    walk.write(folder).unwrap();
    if !has_camera {
        fs::remove_file(folder.join("camera.toml")).unwrap();
    }
    folder.to_path_buf()
}

fn calibrated(sequence: &Path, out: &Path, options: &[&str]) -> Value {
    let arguments = [&["calibrate", shown(sequence), "--out", shown(out), "--json"], options].concat();
    let output = program(&arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Returns the largest distance between the pixels of a ray in the true camera and in another, in the middle three quarters of the
/// picture, where the walk's lines are.
fn lens_error_px(found: &Camera) -> f64 {
    let truth = Sequence::open(Path::new(WALK)).unwrap().setup.camera;
    let (width, height) = (f64::from(truth.width), f64::from(truth.height));
    let mut worst = 0.0_f64;
    for column in 0..16 {
        for row in 4..16 {
            let pixel = DVec2::new(
                width * (0.125 + 0.05 * f64::from(column)),
                height * (f64::from(row) + 0.5) / 16.0,
            );
            let ray = truth.unproject(pixel).unwrap();
            worst = worst.max(found.project_unbounded(ray).unwrap().distance(pixel));
        }
    }
    worst
}

fn value(report: &Value, name: &str) -> f64 {
    report["parameters"][name]["value"].as_f64().unwrap_or_else(|| panic!("{name} in {report}"))
}

/// Checks lens, height and the walk's poses with the new camera. The mean error is that of frames up to the mirror pose.
fn check(report: &Value, sequence: &Path, camera: &Path) {
    let found = read_camera(camera).unwrap();
    let error_px = lens_error_px(&found.camera);
    assert!(error_px < 0.5, "{error_px} px");
    assert!((value(report, "height_m") - 0.52).abs() < 0.003, "{report}");
    assert!(
        report["reprojection_px"].as_f64().unwrap() < 0.3 && report["held_out_px"].as_f64().unwrap() < 0.5
    );
    assert!(report["undetermined"].as_array().unwrap().iter().any(|name| name == "field_scale"));

    let poses = camera.with_extension("tum");
    let tag = ["tag", shown(sequence), "--camera", shown(camera), "--out", shown(&poses), "--backend", "cpu"];
    let output = program(&tag);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let truth = Sequence::open(Path::new(WALK)).unwrap();
    let distance = |a: CameraPose, b: CameraPose| (a.x_m - b.x_m).hypot(a.y_m - b.y_m);
    let errors: Vec<f64> = reality_sim::sequence::read_tum(&poses)
        .unwrap()
        .iter()
        .zip(truth.reference_poses())
        .map(|(found, truth)| {
            let truth = truth.unwrap();
            distance(found.pose, truth).min(distance(found.pose, truth.mirrored()))
        })
        .collect();
    let mean_m = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(errors.len() == 60 && mean_m < 0.005, "{mean_m} m");
}

#[test]
fn a_calibration_that_is_off_is_corrected() {
    let folder = TempDir::new().unwrap();
    let sequence = walk(&folder.path().join("walk"), true);
    let camera = folder.path().join("camera.toml");
    let map = folder.path().join("map.svg");
    let report = calibrated(&sequence, &camera, &["--uncertainty", shown(&map)]);
    let pitch_rad = value(&report, "mount_pitch_rad");
    assert!((pitch_rad + OFF.3).abs() < 0.1_f64.to_radians(), "{pitch_rad}");
    assert!(value(&report, "mount_roll_rad").abs() < 0.1_f64.to_radians());
    check(&report, &sequence, &camera);
    assert!(fs::read_to_string(map).unwrap().ends_with("</svg>\n"));
    // The covariances of the poses contain that of the calibration.
    let corrected = Sequence::open_with_camera(&sequence, Some(&camera)).unwrap();
    let calibration = corrected.calibration.unwrap();
    assert!(calibration.covariance().trace() > 0.0 && calibration.mount_sigma().unwrap().angle_rad < 0.01);
}

#[test]
fn a_lens_of_which_nothing_is_known_is_found() {
    let folder = TempDir::new().unwrap();
    let sequence = walk(&folder.path().join("walk"), false);
    let camera = folder.path().join("camera.toml");
    let report = calibrated(&sequence, &camera, &["--fov-deg", "150"]);
    assert!(value(&report, "mount_pitch_rad").abs() < 0.1_f64.to_radians(), "{report}");
    assert_eq!(report["model"], "OPENCV_FISHEYE");
    // `tag` opens the sequence with the new camera beside its files.
    fs::copy(&camera, sequence.join("camera.toml")).unwrap();
    check(&report, &sequence, &camera);
}

#[test]
fn what_cannot_be_calibrated_is_said_in_one_message() {
    let folder = TempDir::new().unwrap();
    let sequence = walk(&folder.path().join("walk"), true);
    let out = folder.path().join("new.toml");
    assert_fails(
        &["calibrate", shown(&folder.path().join("none")), "--out", shown(&out)],
        &["no such folder"],
    );
    // Its own picture is no place for a camera file.
    let picture = sequence.join("images/000000.jpg");
    assert_fails(&["calibrate", shown(&sequence), "--out", shown(&picture)], &["000000.jpg", "input"]);
    let black = image::RgbImage::new(640, 480);
    for frame in &Sequence::open(&sequence).unwrap().frames {
        black.save(sequence.join(&frame.image)).unwrap();
    }
    // The first twelve pictures are enough to see that none shows a line.
    let text = fs::read_to_string(sequence.join("frames.csv")).unwrap();
    let few: Vec<&str> = text.lines().take(13).collect();
    fs::write(sequence.join("frames.csv"), few.join("\n") + "\n").unwrap();
    let message = assert_fails(&["calibrate", shown(&sequence), "--out", shown(&out)], &["walk"]);
    assert!(message.contains("no lens explains") || message.contains("show enough lines"), "{message}");
    assert!(!out.exists());
}
