//! Logs of robots through the program: `import`, `info`, and commands that take a log.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[path = "../crates/formats/tests/import/cdr.rs"]
mod cdr;
#[allow(dead_code, reason = "other tests use the rest")]
mod common;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../crates/formats/tests/import/log_writer.rs"]
mod log_writer;
#[path = "common/walk_log.rs"]
mod walk_log;

use std::{fs, path::Path};

use serde_json::Value as Json;

use reality_sim::{Sequence, sequence::FrameRecord};

use self::{
    common::{WALK, assert_fails, program, shown, text},
    walk_log::walk_log,
};

fn json(arguments: &[&str]) -> Json {
    let output = program(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_walk_that_went_through_a_log_is_the_same_walk() {
    let walk = Sequence::open(Path::new(WALK)).unwrap();
    let messages = walk_log(&walk, 1);
    let folder = tempfile::tempdir().unwrap();
    let (mcap, bag) = (folder.path().join("walk.mcap"), folder.path().join("walk.db3"));
    fs::write(&mcap, messages.mcap(Some(mcap::Compression::Zstd), Some(1 << 20))).unwrap();
    messages.write_db3(&bag);
    let field = format!("{WALK}/field.toml");
    for log in [&mcap, &bag] {
        let out = log.with_extension("sequence");
        let report = json(&["import", shown(log), "--out", shown(&out), "--field", &field, "--json"]);
        assert_eq!((&report["frames"], &report["unmatched"]), (&60.into(), &0.into()));
        assert_eq!((&report["salvaged"], &report["clock_jumps"]), (&false.into(), &0.into()));
        assert_eq!(report["attitude_source"], "odometry+tf");
        let imported = Sequence::open(&out).unwrap();
        let without_truth = |frame: &FrameRecord| FrameRecord { reference_pose: None, ..frame.clone() };
        assert!(imported.frames.iter().eq(walk.frames.iter().map(without_truth).collect::<Vec<_>>().iter()));
        assert_eq!(imported.setup.camera.distortion, walk.setup.camera.distortion);
        assert_eq!(imported.setup.mount_height_m, walk.setup.mount_height_m);
        assert_eq!(imported.load_image_and_file(30).unwrap().1, walk.load_image_and_file(30).unwrap().1);
    }
}

#[test]
fn commands_take_a_log_and_say_that_it_was_imported() {
    let messages = walk_log(&Sequence::open(Path::new(WALK)).unwrap(), 1);
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("walk.mcap");
    fs::write(&log, messages.mcap(Some(mcap::Compression::Lz4), Some(1 << 20))).unwrap();
    fs::copy(format!("{WALK}/field.toml"), folder.path().join("field.toml")).unwrap();
    let output = program(&["tag", shown(&log), "--frames", "0..3", "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("reality-sim import"));
    let report: Json = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["frames"], 3);
    let quiet = program(&["--quiet", "tag", shown(&log), "--frames", "0..2"]);
    assert!(quiet.status.success() && quiet.stderr.is_empty() && quiet.stdout.is_empty());
}

#[test]
fn info_lists_the_topics_and_what_they_are_taken_for() {
    let messages = walk_log(&Sequence::open(Path::new(WALK)).unwrap(), 1);
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("walk.mcap");
    let bytes = messages.mcap(None, Some(100_000));
    fs::write(&log, &bytes).unwrap();
    let report = json(&["info", shown(&log), "--json"]);
    assert_eq!((&report["messages"], &report["salvaged"]), (&240.into(), &false.into()));
    let taken_for: Vec<&str> = report["topics"]
        .as_array()
        .unwrap()
        .iter()
        .map(|topic| topic["taken_for"].as_str().unwrap())
        .collect();
    assert_eq!(taken_for, ["calibration", "compressed picture", "odometry", "transforms"]);
    assert!((report["topics"][0]["rate_hz"].as_f64().unwrap() - 5.0).abs() < 0.01);

    fs::write(&log, &bytes[..bytes.len() / 2]).unwrap();
    let report = json(&["info", shown(&log), "--json"]);
    assert_eq!(report["salvaged"], true);
    assert!(report["bytes_lost"].as_u64().unwrap() > 0);
}

#[test]
fn what_an_import_needs_is_asked_for() {
    let messages = walk_log(&Sequence::open(Path::new(WALK)).unwrap(), 1);
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("walk.mcap");
    fs::write(&log, messages.mcap(None, None)).unwrap();
    let out = folder.path().join("out");
    let fails = |more: &[&str], words: &[&str]| {
        let mut arguments = vec!["import", shown(&log), "--out", shown(&out)];
        arguments.extend(more);
        assert_fails(&arguments, words);
    };
    fails(&[], &["field.toml", "--field", "spl", "humanoid-kidsize"]);
    fails(&["--field", "spl", "--imu", "/imu"], &["--imu", "/imu"]);
    fails(&["--field", "spl", "--image", "/odom"], &["--image", "/camera/image_raw/compressed"]);
    assert_fails(&["import", WALK, "--out", shown(&out)], &["is a sequence already"]);
    assert_fails(&["import", "no.mcap", "--out", shown(&out)], &["no.mcap", "no such file"]);
    assert_fails(&["tag", shown(&log)], &["--field"]);
    assert!(!out.join("sequence.toml").exists());
}
