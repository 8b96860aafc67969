//! What tests of the program share: running it, and parts of the demonstration walk.

use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

use reality_sim::{CameraPose, Sequence};

pub const WALK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/walk");

pub fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reality-sim")).args(arguments).output().unwrap()
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

pub fn shown(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Asserts exit code 1, one line on standard error with all these words, and nothing on standard output. Returns the line.
pub fn assert_fails(arguments: &[&str], words: &[&str]) -> String {
    let output = program(arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: {message} does not say {word}");
    }
    assert!(output.stdout.is_empty());
    message
}

/// Copies the walk's text files with these frames, and their pictures, into a folder of their own.
#[allow(dead_code, reason = "not every test that shares this file needs a part")]
pub fn part_of_walk(folder: &Path, name: &str, frames: std::ops::Range<usize>) -> PathBuf {
    let mut walk = Sequence::open(Path::new(WALK)).unwrap();
    walk.frames = walk.frames[frames].to_vec();
    walk.start = walk.frames[0].reference_pose.map(CameraPose::planar);
    walk.name = name.to_owned();
    let part = folder.join(name);
    for frame in 0..walk.frames.len() {
        walk.copy_image(frame, &part).unwrap();
    }
    walk.write(&part).unwrap();
    part
}
