//! The program against input that somebody made to break it, against accidents, and against what stands in the way of its
//! outputs. `SECURITY.md` says what is promised.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[path = "../common/mod.rs"]
mod common;
mod killed;
mod memory;
mod outputs;
mod terminal;
mod values;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};

use reality_sim::Sequence;
use tempfile::TempDir;

use common::{WALK, assert_fails, part_of_walk, program, shown, text};

fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_reality-sim"))
}

/// Runs the program and asserts that it succeeds. Returns what it prints.
fn printed(arguments: &[&str]) -> String {
    let output = program(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Makes a short part of the walk and a database of it.
fn short_walk() -> &'static (TempDir, PathBuf, PathBuf) {
    static MADE: OnceLock<(TempDir, PathBuf, PathBuf)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let walk = part_of_walk(folder.path(), "short", 0..8);
        let database = folder.path().join("short.db");
        printed(&["build", shown(&walk), "--out", shown(&database), "--no-hall"]);
        (folder, walk, database)
    })
}

/// Copies the short part of the walk, whose files a test may then spoil.
fn copy_of_short_walk(folder: &Path) -> PathBuf {
    let copy = folder.join("copy");
    let walk = Sequence::open(&short_walk().1).unwrap();
    for frame in 0..walk.frames.len() {
        walk.copy_image(frame, &copy).unwrap();
    }
    walk.write(&copy).unwrap();
    copy
}

/// Changes the text of a file.
fn edit(file: &Path, change: impl FnOnce(String) -> String) {
    let text = fs::read_to_string(file).unwrap();
    let changed = change(text.clone());
    assert_ne!(changed, text, "the change changes something");
    fs::write(file, changed).unwrap();
}

/// Lists the names in a folder.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
