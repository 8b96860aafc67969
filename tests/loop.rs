//! The loop closes: what `gap` finds in a recording corrects the poses and pictures that others make of it.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use reality_sim::{
    Sequence,
    sensor::{Model, effect},
    sequence::{read_camera, read_field, read_mounting},
};
use reality_sim_hidden::{Falloff, Hidden, Recipe};
use serde_json::Value;
use tempfile::TempDir;

fn reality_sim(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reality-sim")).args(arguments).output().unwrap()
}

/// Runs a command with `--json`, which has to succeed, and returns its report.
fn report(arguments: &[&str]) -> Value {
    let output = reality_sim(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Recording that hides one effect, with the report of `gap` on it.
struct Case {
    folder: TempDir,
}

impl Case {
    fn new(hidden: Hidden) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let recipe = Recipe { frames: 40, size: [320, 240], effects: vec![hidden], ..Recipe::new(31) };
        recipe.record(&folder.path().join("recording")).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    fn gap(&self, sequence: &str, out: &str) -> Value {
        report(&["gap", &self.text(sequence), "--out", &self.text(out)])
    }

    /// Returns the mean error of `tag`'s places, metres, with a model of this name.
    fn tagged(&self, model: Option<&str>) -> f64 {
        let recording = self.text("recording");
        let model = model.map(|name| self.text(name));
        let mut arguments = vec!["tag", recording.as_str(), "--backend", "cpu"];
        arguments.extend(model.iter().flat_map(|model| ["--model", model.as_str()]));
        let report = report(&arguments);
        assert_eq!(report["corrections"].is_string(), model.is_some());
        report["error"]["mean_m"].as_f64().unwrap()
    }

    /// Writes the model with the true size of the effect.
    fn write_truth(&self, id: &str, values: &[f64]) {
        let model = Model::default().with(effect(id).unwrap(), values);
        fs::write(self.path("truth.toml"), model.to_toml()).unwrap();
    }

    /// Copies the recording and puts the corrected files of a report in place of its own.
    fn corrected_copy(&self, report: &str) {
        let copy = self.path("corrected");
        let sequence = Sequence::open(&self.path("recording")).unwrap();
        sequence.write(&copy).unwrap();
        fs::create_dir_all(copy.join("images")).unwrap();
        for frame in 0..sequence.frames.len() {
            sequence.copy_image(frame, &copy).unwrap();
        }
        for name in ["camera.toml", "field.toml"] {
            fs::copy(self.path(report).join(name), copy.join(name)).unwrap();
        }
    }
}

fn ids(report: &Value) -> Vec<&str> {
    report["effects"].as_array().unwrap().iter().map(|effect| effect["id"].as_str().unwrap()).collect()
}

/// Asserts that `tag` with the found model is nearly as good as with the true one, and that `gap` finds nothing more in the
/// recording with the corrected files.
fn assert_closed(hidden: Hidden, values: &[f64]) {
    let case = Case::new(hidden);
    case.write_truth(hidden.id(), values);
    let report = case.gap("recording", "report");
    assert_eq!(ids(&report), [hidden.id()]);
    let before = case.tagged(None);
    let (after, best) = (case.tagged(Some("report/model.toml")), case.tagged(Some("truth.toml")));
    assert!(after < 1.5 * best && after < 0.7 * before, "{before} m, {after} m found, {best} m true");
    case.corrected_copy("report");
    let again = case.gap("corrected", "again");
    assert_eq!(ids(&again), Vec::<&str>::new(), "{}", hidden.id());
    let read = |folder: &str| read_mounting(&case.path(folder).join("camera.toml")).unwrap();
    let (first, second) = (read("report"), read("again"));
    assert!((first.pitch_rad - second.pitch_rad).abs() < 1e-9, "nothing found changes nothing");
}

#[test]
fn a_lens_that_is_bent_otherwise_is_corrected_by_what_gap_found() {
    assert_closed(Hidden::RadialDistortion { k: [0.03, 0.0, 0.0, 0.0] }, &[0.03]);
}

#[test]
fn a_field_of_another_size_is_corrected_by_what_gap_found() {
    assert_closed(Hidden::FieldDimensions { length_m: 0.3, width_m: -0.2 }, &[0.3, -0.2]);
}

#[test]
fn a_pitched_mount_is_in_the_corrected_camera_with_its_uncertainty() {
    let case = Case::new(Hidden::MountPitch { angle_rad: 0.02 });
    assert_eq!(ids(&case.gap("recording", "report")), ["mount_pitch"]);
    let camera = case.path("report/camera.toml");
    let mounting = read_mounting(&camera).unwrap();
    assert!((mounting.pitch_rad - 0.02).abs() < 0.003 && mounting.roll_rad.abs() < 1e-9, "{mounting:?}");
    let text = fs::read_to_string(&camera).unwrap();
    let (_, covariance) =
        text.split_once("[covariance]\nparameters = [\"mount_pitch.pitch_rad\"]\nsigma = [").unwrap();
    let (sigma, matrix) = covariance.split_once("]\nmatrix = [\n    [").unwrap();
    let [sigma, variance]: [f64; 2] =
        [sigma, &matrix[..matrix.find(']').unwrap()]].map(|text| text.parse().unwrap());
    assert!(sigma > 0.0 && (mounting.pitch_rad - 0.02).abs() < 4.0 * sigma);
    assert!((variance - sigma * sigma).abs() < 1e-6 * variance);
    case.corrected_copy("report");
    let [stated, corrected] =
        ["recording", "corrected"].map(|name| Sequence::open(&case.path(name)).unwrap());
    for (stated, corrected) in stated.frames.iter().zip(&corrected.frames) {
        assert!((corrected.pitch_rad - stated.pitch_rad - 0.02).abs() < 0.004);
        let [before, after] = [stated, corrected].map(|frame| frame.reference_pose.unwrap().pitch_rad);
        assert!((after - before - 0.02).abs() < 0.004);
    }
    assert_eq!(ids(&case.gap("corrected", "again")), Vec::<&str>::new());
}

#[test]
fn a_database_knows_its_model_and_mixes_pictures_without_the_falloff_of_the_lens() {
    let case = Case::new(Hidden::Vignetting { strength: 0.6, falloff: Falloff::Quadratic });
    case.write_truth("vignetting", &[0.6]);
    let (truth, database) = (case.text("truth.toml"), case.text("walk.db"));
    // Every eighth picture is in the database; those in the middle between them are compared with.
    let sequence = Sequence::open(&case.path("recording")).unwrap();
    let part = |first: usize, name: &str| {
        let mut part = sequence.clone();
        part.frames = sequence.frames.iter().skip(first).step_by(8).cloned().collect();
        part.write(&case.path(name)).unwrap();
        fs::create_dir_all(case.path(name).join("images")).unwrap();
        for frame in (first..sequence.frames.len()).step_by(8) {
            sequence.copy_image(frame, &case.path(name)).unwrap();
        }
        case.text(name)
    };
    let (stored, probes) = (part(0, "stored"), part(4, "probes"));
    report(&["build", &stored, "--out", &database, "--no-hall"]);
    let psnr = |arguments: &[&str]| {
        let report = report(
            &[&["evaluate", &database, &probes, "--backend", "cpu", "--best-effort"], arguments].concat(),
        );
        report["methods"]["blend"]["psnr_field_db"].as_f64().unwrap()
    };
    let (before, after) = (psnr(&[]), psnr(&["--model", &truth]));
    assert!(after > before + 0.4, "{before} dB without, {after} dB with the model");

    let corrected = case.text("corrected.db");
    let pitch = case.text("pitch.toml");
    let model = Model::default().with(effect("mount_pitch").unwrap(), [0.01]);
    fs::write(Path::new(&pitch), model.to_toml()).unwrap();
    report(&["build", &stored, "--out", &corrected, "--no-hall", "--model", &pitch]);
    report(&["evaluate", &corrected, &probes, "--model", &pitch, "--backend", "cpu", "--best-effort"]);
    let refused = reality_sim(&["evaluate", &corrected, &probes, "--model", &truth]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1));
    assert!(message.contains("corrected.db: was built with another model"), "{message}");
}

#[test]
fn a_model_that_leaves_no_camera_is_an_error_that_names_the_file() {
    let case = Case::new(Hidden::CameraHeight { height_m: 0.0 });
    for text in ["[[effect]]\nid = \"focal_length\"\nscale = -2.0\n", "[[effect]]\nid = \"nothing\"\n"] {
        fs::write(case.path("bad.toml"), text).unwrap();
        let (recording, bad) = (case.text("recording"), case.text("bad.toml"));
        for command in [vec!["tag", &recording], vec!["build", &recording, "--out", "never.db"]] {
            let output = reality_sim(&[command, vec!["--model", &bad]].concat());
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(1), "{message}");
            assert!(message.contains("bad.toml") && message.lines().count() == 1, "{message}");
        }
    }
    assert!(!Path::new("never.db").exists());
}

#[test]
fn corrected_files_of_a_recording_without_an_effect_are_its_own() {
    let case = Case::new(Hidden::CameraHeight { height_m: 0.0 });
    case.gap("recording", "report");
    let files = |folder: &str| {
        let folder = case.path(folder);
        (read_camera(&folder.join("camera.toml")).unwrap(), read_field(&folder.join("field.toml")).unwrap())
    };
    let ((camera, field), (own_camera, own_field)) = (files("report"), files("recording"));
    assert_eq!((camera.camera, field), (own_camera.camera, own_field));
}
