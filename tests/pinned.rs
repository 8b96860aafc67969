//! Comparison of the program's output for unchanging recordings with the pinned output of earlier versions, which a
//! redesign must not change. `PINNED=write cargo test --test pinned` writes `tests/pinned/` anew; review the difference
//! before committing it.
//!
//! On one processor the same seed gives the same bits. Other processors round differently (fused multiplications), which a
//! particle filter's resampling amplifies to less than a millimetre: hence the tolerances.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use image::{RgbImage, imageops};
use reality_sim_hidden::{Hidden, Random, Recipe};
use serde_json::Value;
use tempfile::TempDir;

/// Relative tolerance of the numbers in a report.
const RELATIVE: f64 = 1e-3;
/// Size below which a number is rounding.
const NOTHING: f64 = 1e-9;
/// Tolerance of places, metres, and angles, radians: a tenth of the localization error.
const POSE: f64 = 1e-3;
/// Tolerance of the mean colours of 8 × 8 pixels, grey levels.
const LEVELS: u8 = 1;
/// Keys whose values are measured times.
const MEASURED_TIMES: [&str; 1] = ["seconds_per_frame"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn run(arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_reality-sim")).current_dir(root()).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Returns the path of the pinned file; `None` if it has just been written anew.
fn pinned(name: &str, write: impl FnOnce(&Path)) -> Option<PathBuf> {
    let path = root().join("tests/pinned").join(name);
    if env::var_os("PINNED").is_some_and(|value| value == "write") {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        write(&path);
        return None;
    }
    assert!(path.exists(), "{}: run PINNED=write cargo test --test pinned", path.display());
    Some(path)
}

fn assert_text(name: &str, text: &str, agree: impl Fn(&str, &str)) {
    if let Some(path) = pinned(name, |path| fs::write(path, text).unwrap()) {
        agree(&fs::read_to_string(path).unwrap(), text);
    }
}

/// Asserts that both texts have the same words, and numbers that agree.
fn same_numbers(name: &str, before: &str, now: &str, agree: impl Fn(f64, f64) -> bool) {
    let words = |text: &str| -> Vec<String> {
        text.split([' ', ',', '\n']).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let (before, now) = (words(before), words(now));
    assert_eq!(before.len(), now.len(), "{name}");
    for (before, now) in before.iter().zip(&now) {
        match (before.parse::<f64>(), now.parse::<f64>()) {
            (Ok(before), Ok(now)) => assert!(agree(before, now), "{name}: {before} was, {now} is"),
            _ => assert_eq!(before, now, "{name}"),
        }
    }
}

fn is_close(before: f64, now: f64) -> bool {
    (before - now).abs() <= NOTHING + RELATIVE * before.abs().max(now.abs())
}

/// Whether two probabilities have about the same size: their logarithms agree.
fn is_as_likely(before: f64, now: f64) -> bool {
    let log = |p: f64| p.max(1e-300).log10();
    (log(before) - log(now)).abs() <= 1e-3 + RELATIVE * log(before).abs()
}

fn assert_value(place: &str, before: &Value, now: &Value) {
    match (before, now) {
        (Value::Object(before), Value::Object(now)) => {
            // Keys may be added but not removed.
            for key in before.keys() {
                assert!(now.contains_key(key), "{place}.{key} is gone");
            }
            for (key, before) in before.iter().filter(|(key, _)| !MEASURED_TIMES.contains(&key.as_str())) {
                assert_value(&format!("{place}.{key}"), before, &now[key]);
            }
        }
        (Value::Array(before), Value::Array(now)) => {
            assert_eq!(before.len(), now.len(), "{place}");
            for (index, (before, now)) in before.iter().zip(now).enumerate() {
                assert_value(&format!("{place}[{index}]"), before, now);
            }
        }
        (Value::Number(before), Value::Number(now)) => {
            let (before, now) = (before.as_f64().unwrap(), now.as_f64().unwrap());
            let agree = if place.ends_with("p_value") { is_as_likely } else { is_close };
            assert!(agree(before, now), "{place}: {before} was, {now} is");
        }
        _ => assert_eq!(before, now, "{place}"),
    }
}

fn assert_json(name: &str, text: &str) {
    let now: Value = serde_json::from_str(text).unwrap();
    assert_text(name, &serde_json::to_string_pretty(&now).unwrap(), |before, _| {
        assert_value(name, &serde_json::from_str(before).unwrap(), &now);
    });
}

/// Compares the mean colours of 8 × 8 pixels with the pinned ones.
fn assert_picture(name: &str, picture: &RgbImage) {
    let (width, height) = (picture.width() / 8, picture.height() / 8);
    let small = imageops::resize(picture, width, height, imageops::FilterType::Triangle);
    let Some(path) = pinned(name, |path| small.save(path).unwrap()) else { return };
    let before = image::open(path).unwrap().into_rgb8();
    assert_eq!(before.dimensions(), small.dimensions(), "{name}");
    let differs = |(before, now): (&u8, &u8)| before.abs_diff(*now) > LEVELS;
    let different = before.as_raw().iter().zip(small.as_raw()).filter(|pair| differs(*pair)).count();
    assert_eq!(different, 0, "{name}: so many numbers differ");
}

/// Compares everything that `gap` writes for a recording.
fn assert_gap(name: &str, recording: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let json = run(&["gap", recording.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
    assert_json(&format!("{name}/report.json"), &json);
    let model = fs::read_to_string(out.join("model.toml")).unwrap();
    assert_text(&format!("{name}/model.toml"), &model, |before, now| {
        same_numbers(name, before, now, is_close);
    });
    let drawn = image::open(out.join("pictures/after.png")).unwrap().into_rgb8();
    assert_picture(&format!("{name}/after.png"), &drawn);
}

/// Makes a small ray-traced recording with this effect, if any.
fn hidden(seed: u64, effect: Option<(&str, f64)>) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let effects = effect.map(|(id, multiple)| Hidden::of(id, multiple, &mut Random::new(seed)).unwrap());
    let recipe =
        Recipe { frames: 32, size: [320, 240], effects: effects.into_iter().collect(), ..Recipe::new(seed) };
    recipe.record(folder.path()).unwrap();
    folder
}

fn assert_tags(name: &str, options: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let [poses, details] = ["poses.tum", "details.csv"].map(|file| folder.path().join(file));
    let mut arguments =
        vec!["tag", "assets/walk", "--frames", "0..24", "--backend", "cpu", "--json", "--out"];
    arguments.extend([poses.to_str().unwrap(), "--details", details.to_str().unwrap()]);
    arguments.extend(options);
    run(&arguments);
    let poses = fs::read_to_string(poses).unwrap();
    assert_text(&format!("{name}.tum"), &poses, |before, now| {
        same_numbers(name, before, now, |before, now| (before - now).abs() < POSE);
    });
    let details = fs::read_to_string(details).unwrap();
    assert_text(&format!("{name}.csv"), &details, |before, now| {
        // The columns up to the standard deviations hold the pose; the effective sample size needs to agree only to a
        // tenth.
        same_numbers(name, before, now, |before, now| {
            (before - now).abs() < POSE + 0.1 * before.abs().max(now.abs())
        });
    });
}

#[test]
fn the_gap_of_the_demonstration_walk_is_as_before() {
    assert_gap("walk", &root().join("assets/walk"));
}

#[test]
fn the_gap_of_a_recording_by_another_renderer_is_as_before() {
    assert_gap("pitch", &root().join("assets/pitch"));
}

#[test]
fn the_gap_of_a_recording_with_nothing_hidden_is_as_before() {
    assert_gap("nothing_hidden", hidden(1, None).path());
}

#[test]
fn the_gap_of_a_recording_with_a_hidden_effect_is_as_before() {
    assert_gap("vignetting_hidden", hidden(4, Some(("vignetting", 6.0))).path());
}

#[test]
fn the_gap_of_a_recording_with_an_effect_that_nobody_knows_is_as_before() {
    assert_gap("unknown_hidden", hidden(5, Some(("lens_dirt", 6.0))).path());
}

#[test]
fn tags_of_every_observation_model_are_as_before() {
    for model in ["gauss", "distance", "contrast"] {
        assert_tags(&format!("tags/{model}"), &["--observation", model]);
    }
}

#[test]
fn smoothed_tags_and_those_without_a_start_are_as_before() {
    assert_tags("tags/smooth", &["--smooth"]);
    assert_tags("tags/unknown_start", &["--unknown-start"]);
}

#[test]
fn pictures_at_a_pose_are_as_before() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("walk.db");
    let database = database.to_str().unwrap();
    run(&["build", "assets/walk", "--out", database]);
    for method in ["nearest", "quadratic", "plane", "blend", "simulated"] {
        let out = folder.path().join(format!("{method}.png"));
        let out_text = out.to_str().unwrap();
        run(&["render", database, "--pose=-2.3,0.2,1.6", "--method", method, "--out", out_text]);
        assert_picture(&format!("pictures/{method}.png"), &image::open(&out).unwrap().into_rgb8());
    }
}
