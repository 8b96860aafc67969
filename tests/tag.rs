//! `reality-sim tag`, run as users run it, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use serde_json::Value;
use tempfile::TempDir;

const WALK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/walk");

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_reality-sim"))
}

fn tag(sequence: &Path, arguments: &[&str]) -> Output {
    program().arg("tag").arg(sequence).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Returns the one JSON object on standard output.
fn tag_json(arguments: &[&str]) -> Value {
    let output = tag(Path::new(WALK), &[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Returns the error statistics of the first 30 pictures.
fn error_of(observation: &str) -> (f64, u64) {
    let report = tag_json(&["--observation", observation, "--frames", "0..30"]);
    let error = &report["error"];
    (error["mean_m"].as_f64().unwrap(), error["lost_frames"].as_u64().unwrap())
}

#[test]
fn contrast_follows_the_walk_to_15_mm() {
    let (mean_m, lost_frames) = error_of("contrast");
    assert!(mean_m <= 0.015 && lost_frames == 0, "{mean_m} m, {lost_frames} lost");
}

#[test]
fn the_gauss_model_follows_the_walk_to_3_cm() {
    let (mean_m, lost_frames) = error_of("gauss");
    assert!(mean_m <= 0.03 && lost_frames == 0, "{mean_m} m, {lost_frames} lost");
}

#[test]
fn the_distance_model_follows_the_walk_to_4_cm() {
    let (mean_m, lost_frames) = error_of("distance");
    assert!(mean_m <= 0.04 && lost_frames == 0, "{mean_m} m, {lost_frames} lost");
}

#[test]
fn an_unknown_start_is_found() {
    let report = tag_json(&["--unknown-start", "--frames", "0..8"]);
    let error = &report["error"];
    assert!(error["max_m"].as_f64().unwrap() < 0.1, "{report}");
    assert!(report["searched_frames"].as_u64().unwrap() >= 1, "{report}");
}

#[test]
fn a_range_of_frames_starts_at_the_dead_reckoned_pose() {
    let report = tag_json(&["--frames", "20..24"]);
    assert_eq!(report["frames"], 4);
    assert!(report["error"]["max_m"].as_f64().unwrap() < 0.1, "{report}");
}

#[test]
fn json_is_one_object_with_all_keys_and_finite_numbers() {
    let report = tag_json(&["--frames", "0..4", "--particles", "300", "--seed", "7", "--backend", "cpu"]);
    for (key, value) in [
        ("frames", Value::from(4)),
        ("particles", 300.into()),
        ("observation", "contrast".into()),
        ("backend", "cpu".into()),
        ("seed", 7.into()),
        ("iterations", 5.into()),
        ("resampling", "residual".into()),
        ("smoothed", false.into()),
        ("out", Value::Null),
    ] {
        assert_eq!(report[key], value, "{key}");
    }
    assert!(report["sure_frames"].is_u64() && report["searched_frames"].is_u64(), "{report}");
    assert!(report["seconds_per_frame"].as_f64().unwrap() > 0.0);
    for key in ["mean_m", "median_m", "rmse_m", "p95_m", "max_m", "mean_yaw_rad", "lost_frames"] {
        assert!(report["error"][key].as_f64().is_some_and(f64::is_finite), "{key}");
    }
}

#[test]
fn without_ground_truth_there_is_no_error() {
    let walk = Walk::new(2);
    walk.edit("sequence.toml", |text| text.replace("groundtruth = ", "# groundtruth = "));
    let output = tag(&walk.folder(), &["--json", "--particles", "100"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report.get("error").is_none(), "{report}");
    // The pictures tell how good the poses are all the same.
    assert!(report["lines_within_5px"].as_f64().unwrap() > 0.9, "{report}");
}

#[test]
fn the_report_says_how_many_lines_are_met_and_whether_that_is_good() {
    let report = tag_json(&["--frames", "0..10"]);
    let fraction = |report: &Value, key: &str| report[key].as_f64().unwrap();
    let [near, wide] = ["lines_within_5px", "lines_within_10px"].map(|key| fraction(&report, key));
    assert!(near > 0.9 && near <= wide && wide <= 1.0, "{report}");
    assert_eq!(fraction(&report, "completeness"), 1.0);
    assert!(report["lines_verdict"].as_str().unwrap().contains("good"), "{report}");
    // A focal length 12 % off.
    let walk = Walk::new(10);
    walk.edit("camera.toml", |text| text.replace("214.906223", "240"));
    let output = tag(&walk.folder(), &["--json"]);
    let wrong: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(fraction(&wrong, "lines_within_5px") < near - 0.1, "{wrong}");
    assert!(!wrong["lines_verdict"].as_str().unwrap().contains("good"), "{wrong}");
}

#[test]
fn in_a_pipe_the_report_comes_without_a_progress_bar() {
    let output = tag(Path::new(WALK), &["--frames", "0..3", "--particles", "200"]);
    let lines = text(&output.stdout);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    for word in
        ["walk, 3 frames", "contrast, 200 particles", "ms a frame", "of the field's lines are met", "mean"]
    {
        assert!(lines.contains(word), "{word} is not in {lines}");
    }
}

#[test]
fn the_same_seed_gives_the_same_file_on_any_number_of_threads() {
    let folder = TempDir::new().unwrap();
    let poses = |name: &str, threads: &str, seed: &str| {
        let out = folder.path().join(name);
        let status = program()
            .args(["tag", WALK, "--frames", "0..6", "--particles", "300", "--seed", seed, "--out"])
            .arg(&out)
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap()
            .status;
        assert!(status.success());
        fs::read(out).unwrap()
    };
    let first = poses("first", "2", "5");
    assert!(first == poses("second", "2", "5"), "the same seed twice");
    assert!(first == poses("third", "1", "5"), "one thread and two");
    assert!(first != poses("fourth", "2", "6"), "another seed");
}

#[test]
fn poses_details_and_overlays_have_one_entry_a_frame() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (out, details, overlay) = (path("poses.tum"), path("frames.csv"), path("pictures"));
    fs::write(&out, "an old file").unwrap();
    tag_json(&[
        "--frames",
        "2..5",
        "--out",
        &out,
        "--details",
        &details,
        "--overlay",
        &overlay,
        "--particles",
        "200",
    ]);
    let poses = reality_sim::sequence::read_tum(Path::new(&out)).unwrap();
    assert_eq!(poses.iter().map(|pose| pose.timestamp_s).collect::<Vec<_>>(), [0.6, 0.8, 1.0]);

    let table = fs::read_to_string(&details).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 4);
    assert!(rows.iter().all(|row| row.len() == 28), "{table}");
    assert_eq!(rows[0][..4], ["timestamp_s", "x_m", "y_m", "yaw_rad"]);
    assert!(rows[1..].iter().all(|row| row[7].parse::<f64>().unwrap() > 0.0), "sigma_x_m");

    for index in 2..5 {
        let picture = image::open(format!("{overlay}/{index:06}.jpg")).unwrap();
        assert_eq!((picture.width(), picture.height()), (640, 480));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3, "no temporary files are left");
}

#[test]
fn another_field_and_camera_can_be_given() {
    let camera = format!("{WALK}/camera.toml");
    for field in ["humanoid-kidsize-2010", &format!("{WALK}/field.toml")] {
        let report =
            tag_json(&["--frames", "0..2", "--particles", "200", "--field", field, "--camera", &camera]);
        assert!(report["error"]["max_m"].as_f64().unwrap() < 0.05, "{report}");
    }
}

/// Copy of the beginning of the demonstration walk, to be broken.
struct Walk(TempDir);

impl Walk {
    fn new(frames: usize) -> Self {
        let walk = Self(TempDir::new().unwrap());
        fs::create_dir_all(walk.path("images")).unwrap();
        for name in ["sequence.toml", "camera.toml", "field.toml", "groundtruth.tum"] {
            fs::copy(Path::new(WALK).join(name), walk.path(name)).unwrap();
        }
        let table = fs::read_to_string(Path::new(WALK).join("frames.csv")).unwrap();
        let rows: Vec<&str> = table.lines().take(1 + frames).collect();
        fs::write(walk.path("frames.csv"), rows.join("\n")).unwrap();
        for index in 0..frames {
            let name = format!("images/{index:06}.jpg");
            fs::copy(Path::new(WALK).join(&name), walk.path(&name)).unwrap();
        }
        walk
    }

    fn folder(&self) -> PathBuf {
        self.0.path().join("walk")
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    fn edit(&self, name: &str, change: impl FnOnce(String) -> String) {
        let path = self.path(name);
        fs::write(&path, change(fs::read_to_string(&path).unwrap())).unwrap();
    }
}

/// Asserts exit code 1, nothing on standard output, one line on standard error that contains all `words`, and no file
/// `out`.
fn assert_fails(sequence: &Path, arguments: &[&str], words: &[&str]) {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("poses.tum");
    let mut command = program();
    command.arg("tag").arg(sequence).args(["--particles", "50"]);
    if !arguments.contains(&"--out") {
        command.arg("--out").arg(&out);
    }
    let output = command.args(arguments).output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.starts_with("error: ") && message.lines().count() == 1, "{message}");
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
    for word in words {
        assert!(message.contains(word), "{word} is not in {message}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "something is left: {message}");
}

#[test]
fn a_folder_that_is_not_a_sequence_is_named() {
    let folder = TempDir::new().unwrap();
    assert_fails(&folder.path().join("nowhere"), &[], &["nowhere", "no such folder"]);
    assert_fails(folder.path(), &[], &["sequence.toml", "no such file"]);
    assert_fails(&Path::new(WALK).join("camera.toml"), &[], &["camera.toml", "not a folder"]);
}

#[test]
fn broken_files_are_named_with_their_line() {
    let broken = |name: &str, from: &str, to: &str, words: &[&str]| {
        let walk = Walk::new(2);
        walk.edit(name, |text| {
            assert!(text.contains(from), "{from} is not in {name}");
            text.replacen(from, to, 1)
        });
        assert_fails(&walk.folder(), &[], &[&[name], words].concat());
    };
    broken("sequence.toml", "name = ", "name ", &["line 1"]);
    broken("sequence.toml", "\"frames.csv\"", "\"../frames.csv\"", &["inside the sequence's folder"]);
    broken("camera.toml", "width = 640", "width = 0", &["width"]);
    broken("camera.toml", "OPENCV_FISHEYE", "FISHY", &["not known"]);
    broken("field.toml", "length_m = 6.0", "length_m = nan", &["length_m"]);
    broken("frames.csv", "0.43457", "NaN", &["line 2", "pitch_rad"]);
    broken("frames.csv", "0.400", "0.100", &["line 3", "timestamp"]);
    broken("frames.csv", "odometry_x_m,", "", &["odometry_x_m"]);
    broken("groundtruth.tum", "0.200 ", "", &["line 1"]);
}

#[test]
fn broken_pictures_are_named() {
    let picture = "images/000001.jpg";
    let walk = Walk::new(2);
    fs::remove_file(walk.path(picture)).unwrap();
    assert_fails(&walk.folder(), &[], &["000001.jpg", "no such file"]);

    // The first one: the poses before a later one are written.
    let picture = "images/000000.jpg";
    let walk = Walk::new(2);
    let bytes = fs::read(walk.path(picture)).unwrap();
    fs::write(walk.path(picture), &bytes[..bytes.len() / 2]).unwrap();
    assert_fails(&walk.folder(), &[], &["000000.jpg", "cut off"]);

    let walk = Walk::new(2);
    fs::write(walk.path(picture), "not a picture").unwrap();
    assert_fails(&walk.folder(), &[], &["000000.jpg", "neither a JPEG nor a PNG"]);

    let walk = Walk::new(2);
    image::RgbImage::new(64, 48).save(walk.path("images/small.png")).unwrap();
    walk.edit("frames.csv", |text| text.replace(picture, "images/small.png"));
    assert_fails(&walk.folder(), &[], &["small.png", "64 x 48"]);
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_any_picture_is_read() {
    // A picture is missing: a complaint about the output shows that no picture was read before.
    let walk = Walk::new(1);
    fs::remove_file(walk.path("images/000000.jpg")).unwrap();
    let below_a_file = walk.path("camera.toml/poses.tum");
    let in_no_folder = walk.path("nowhere/poses.tum");
    for option in ["--out", "--details", "--overlay"] {
        assert_fails(&walk.folder(), &[option, below_a_file.to_str().unwrap()], &["camera.toml"]);
        if option != "--overlay" {
            let arguments = [option, in_no_folder.to_str().unwrap()];
            assert_fails(&walk.folder(), &arguments, &["nowhere", "create it first"]);
        }
        assert!(!walk.path("nowhere").exists());
    }
    let folder = walk.folder();
    assert_fails(&walk.folder(), &["--out", folder.to_str().unwrap()], &["is a folder"]);
}

#[test]
fn inputs_are_never_overwritten() {
    let walk = Walk::new(1);
    for name in
        ["sequence.toml", "camera.toml", "field.toml", "frames.csv", "groundtruth.tum", "images/000000.jpg"]
    {
        let before = fs::read(walk.path(name)).unwrap();
        for option in ["--out", "--details"] {
            let path = walk.path(name);
            assert_fails(&walk.folder(), &[option, path.to_str().unwrap()], &[name, "is an input"]);
        }
        assert_eq!(fs::read(walk.path(name)).unwrap(), before, "{name}");
    }
    let images = walk.path("images");
    assert_fails(&walk.folder(), &["--overlay", images.to_str().unwrap()], &["images", "holds the input"]);
}

#[test]
fn two_outputs_with_the_same_name_are_refused() {
    let folder = TempDir::new().unwrap();
    let same = folder.path().join("same");
    let same = same.to_str().unwrap();
    assert_fails(Path::new(WALK), &["--out", same, "--details", same], &["same", "two outputs"]);
}

#[test]
fn values_that_cannot_be_used_are_named() {
    let walk = Path::new(WALK);
    assert_fails(walk, &["--frames", "0..61"], &["assets/walk", "60 frames"]);
    assert_fails(walk, &["--frames", "60.."], &["assets/walk", "60 frames"]);
    assert_fails(walk, &["--field", "no-such-field"], &["no-such-field", "humanoid-kidsize-2010"]);
    assert_fails(walk, &["--camera", "no-such.toml"], &["no-such.toml", "no such file"]);
    assert_fails(walk, &["--adapter", "no-such-card"], &["no-such-card", "graphics adapter"]);
    assert_fails(walk, &["--adaptive", "--backend", "gpu"], &["--adaptive", "--backend cpu"]);
}

#[test]
fn wrong_usage_exits_with_2() {
    for arguments in [
        &[] as &[&str],
        &["no-such-command"],
        &["tag"],
        &["tag", WALK, "--observation", "colour"],
        &["tag", WALK, "--particles", "0"],
        &["tag", WALK, "--particles", "many"],
        &["tag", WALK, "--iterations", "0"],
        &["tag", WALK, "--seed", "-1"],
        &["tag", WALK, "--frames", "5..2"],
        &["tag", WALK, "--frames", "5"],
        &["tag", WALK, "--start", "1,2"],
        &["tag", WALK, "--start", "1,2,NaN"],
        &["tag", WALK, "--start", "1,2,3", "--unknown-start"],
        &["tag", WALK, "--alpha", "0"],
        &["tag", WALK, "--alpha", "10"],
        &["tag", WALK, "--blur", "-1"],
        &["tag", WALK, "--no-border-mask"],
        &["tag", WALK, "--adapter", "any", "--backend", "cpu"],
        &["tag", WALK, "--no-such-option"],
    ] {
        let output = program().args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{arguments:?}");
    }
}

#[test]
fn help_and_version_exit_with_0() {
    for arguments in [&["--help"] as &[&str], &["--version"], &["tag", "--help"], &["doctor", "--help"]] {
        let output = program().args(arguments).output().unwrap();
        assert!(output.status.success() && !output.stdout.is_empty(), "{arguments:?}");
    }
}
