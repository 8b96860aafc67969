//! `build`, `info`, `render` and `evaluate`, run as users run them, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod building;
mod models;
mod refusals;
mod rendering;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::OnceLock,
};

use reality_sim::Sequence;
use serde_json::Value;
use tempfile::TempDir;

const WALK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/walk");

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reality-sim")).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = program(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "nothing is shown in a pipe: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Asserts exit code 1, one line on standard error with all these words, and nothing on standard output.
fn assert_fails(arguments: &[&str], words: &[&str]) {
    let output = program(arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: {message} does not say {word}");
    }
    assert!(output.stdout.is_empty());
}

fn shown(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Copies the walk's text files with these frames into a folder of their own; the pictures are linked.
fn part_of_walk(folder: &Path, name: &str, frames: std::ops::Range<usize>) -> PathBuf {
    let mut walk = Sequence::open(Path::new(WALK)).unwrap();
    walk.frames = walk.frames[frames].to_vec();
    walk.start = walk.frames[0].reference_pose.map(reality_sim::CameraPose::planar);
    walk.name = name.to_owned();
    let part = folder.join(name);
    for frame in 0..walk.frames.len() {
        walk.copy_image(frame, &part).unwrap();
    }
    walk.write(&part).unwrap();
    part
}

/// Makes a database of the walk's first 40 pictures, and a sequence of its other 20 as probes.
fn demonstration() -> &'static (TempDir, PathBuf, PathBuf) {
    static MADE: OnceLock<(TempDir, PathBuf, PathBuf)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let walk = part_of_walk(folder.path(), "recorded", 0..40);
        let probes = part_of_walk(folder.path(), "probes", 40..60);
        let database = folder.path().join("walk.db");
        let report = json(&["build", shown(&walk), "--out", shown(&database)]);
        assert_eq!(report["images"], 40);
        (folder, database, probes)
    })
}

fn copy_of_database(folder: &Path) -> PathBuf {
    let copy = folder.join("copy.db");
    fs::copy(&demonstration().1, &copy).unwrap();
    copy
}
