//! `build`, `render --clean` and `evaluate --clean`, run as users run them, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{
    path::{Path, PathBuf},
    sync::OnceLock,
};

use serde_json::Value;
use tempfile::TempDir;

use common::{assert_fails, part_of_walk, program, shown, text};

/// Pose in the middle of the walk.
const POSE: &str = "-2.05,0.9,1.6";

fn json(arguments: &[&str]) -> Value {
    let output = program(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Makes a database with a clean stage, one without, and probes.
fn made() -> &'static (TempDir, [PathBuf; 3], Value) {
    static MADE: OnceLock<(TempDir, [PathBuf; 3], Value)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let walk = part_of_walk(folder.path(), "recorded", 0..50);
        let probes = part_of_walk(folder.path(), "probes", 50..60);
        let [clean, plain] = ["clean.db", "plain.db"].map(|name| folder.path().join(name));
        let report = json(&["build", shown(&walk), "--out", shown(&clean)]);
        let without = json(&["build", shown(&walk), "--out", shown(&plain), "--no-clean"]);
        assert!(without.get("clean").is_none(), "{without:#}");
        (folder, [clean, plain, probes], report)
    })
}

fn render(database: &Path, out: &Path, options: &[&str]) -> Value {
    let arguments = ["render", shown(database), "--pose", POSE, "--method", "blend", "--out", shown(out)];
    json(&[&arguments, options].concat())
}

#[test]
fn build_finds_the_clean_stage_and_says_how_much_it_knows() {
    let (folder, [clean, ..], report) = made();
    let unknown = report["clean"]["unknown_share"].as_f64().unwrap();
    assert!((0.0..1.0).contains(&unknown), "{report:#}");
    assert!(report["clean"]["masked_images"].as_u64().unwrap() <= 50, "{report:#}");
    let recorded = folder.path().join("recorded");
    let again = json(&["build", shown(&recorded), "--out", shown(clean)]);
    assert!(again.get("clean").is_none(), "it is there already: {again:#}");
    let output = program(&["build", shown(&recorded), "--out", shown(&folder.path().join("words.db"))]);
    assert!(text(&output.stdout).contains("of the carpet were seen empty"), "{}", text(&output.stdout));
}

#[test]
fn pictures_without_the_option_are_the_same_with_and_without_a_clean_stage() {
    let (folder, [clean, plain, _], _) = made();
    let [a, b] = ["a.png", "b.png"].map(|name| folder.path().join(name));
    render(clean, &a, &[]);
    render(plain, &b, &[]);
    assert_eq!(image::open(a).unwrap(), image::open(b).unwrap());
}

#[test]
fn clean_pictures_are_made_and_compared() {
    let (folder, [clean, _, probes], _) = made();
    let out = folder.path().join("clean.png");
    let report = render(clean, &out, &["--clean"]);
    assert!(report["covered"].as_f64().unwrap() > 0.8, "{report:#}");
    assert_eq!(image::open(&out).unwrap().into_rgb8().dimensions(), (640, 480));
    let [plain, cleaned] = [&[][..], &["--clean"]]
        .map(|options| json(&[&["evaluate", shown(clean), shown(probes)], options].concat()));
    assert_eq!((&plain["clean"], &cleaned["clean"]), (&Value::Bool(false), &Value::Bool(true)));
    for method in ["nearest", "quadratic", "plane", "blend"] {
        assert_eq!(cleaned["methods"][method]["answered"], 1.0, "{cleaned:#}");
    }
}

#[test]
fn where_there_is_no_clean_stage_the_remedy_is_named() {
    let (folder, [_, plain, probes], _) = made();
    let out = folder.path().join("none.png");
    let words = [shown(plain), "holds no clean stage", "reality-sim build"];
    assert_fails(&["render", shown(plain), "--pose", POSE, "--clean", "--out", shown(&out)], &words);
    assert_fails(&["evaluate", shown(plain), shown(probes), "--clean"], &words);
    assert!(!out.exists());
    let recorded = folder.path().join("recorded");
    let later = folder.path().join("later.db");
    std::fs::copy(plain, &later).unwrap();
    let report = json(&["build", shown(&recorded), "--out", shown(&later)]);
    assert!(report.get("clean").is_some(), "{report:#}");
    render(&later, &out, &["--clean"]);
}

#[test]
fn a_simulated_picture_cannot_be_cleaned() {
    let (folder, [clean, ..], _) = made();
    let out = folder.path().join("simulated.png");
    let arguments =
        ["render", shown(clean), "--pose", POSE, "--method", "simulated", "--clean", "--out", shown(&out)];
    let output = program(&arguments);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--clean"), "{}", text(&output.stderr));
}
