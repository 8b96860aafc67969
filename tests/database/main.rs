//! `build`, `info`, `render` and `evaluate`, run as users run them, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod building;
#[path = "../common/mod.rs"]
mod common;
mod models;
mod refusals;
mod rendering;

use std::{
    fs,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use serde_json::Value;
use tempfile::TempDir;

use common::{WALK, assert_fails, part_of_walk, program, shown, text};

fn json(arguments: &[&str]) -> Value {
    let output = program(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "nothing is shown in a pipe: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
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
