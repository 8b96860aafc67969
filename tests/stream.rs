//! `reality-sim stream`: messages of ROS 2, read again by `import`, which knows nothing of how they were written.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{fs, path::Path};

use common::{assert_fails, part_of_walk, program, shown, text};
use reality_sim::{Pose2, Sequence, StampedPose, write_tum};
use serde_json::Value;

/// Runs the program, which succeeds, and returns the JSON object that it prints.
fn report(arguments: &[&str]) -> Value {
    let output = program(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Makes a database of some pictures of the walk, and a path along them.
fn database(folder: &Path) -> (Sequence, String, String) {
    let walk = part_of_walk(folder, "walk", 0..8);
    let (database, path) = (folder.join("walk.db"), folder.join("path.tum"));
    report(&["build", shown(&walk), "--no-hall", "--out", shown(&database)]);
    let walk = Sequence::open(&walk).unwrap();
    let poses = walk.frames.iter().zip(walk.reference_poses());
    let poses: Vec<StampedPose> = poses
        .map(|(frame, pose)| StampedPose { timestamp_s: frame.timestamp_s, pose: pose.unwrap() })
        .collect();
    write_tum(&path, &poses).unwrap();
    (walk, shown(&database).to_owned(), shown(&path).to_owned())
}

#[test]
fn what_is_streamed_is_a_log_of_the_same_camera_at_the_same_poses() {
    let folder = tempfile::tempdir().unwrap();
    let (walk, database, path) = database(folder.path());
    let (log, field) = (folder.path().join("stream.mcap"), folder.path().join("walk/field.toml"));
    let said = report(&["stream", &database, "--path", &path, "--ball", "-2.3,1.2", "--out", shown(&log)]);
    assert_eq!(said["pictures"], 8);
    let topics = report(&["info", shown(&log)]);
    let topics: Vec<&str> =
        topics["topics"].as_array().unwrap().iter().map(|topic| topic["name"].as_str().unwrap()).collect();
    assert_eq!(topics.len(), 7, "{topics:?}");

    let again = folder.path().join("again");
    let arguments =
        ["--image", "/camera/image_raw", "--reference", "camera_optical", "--field", shown(&field)];
    report(&[&["import", shown(&log), "--out", shown(&again)], arguments.as_slice()].concat());
    let again = Sequence::open(&again).unwrap();
    assert_eq!(again.frames.len(), 8);
    let (ours, theirs) = (&walk.setup.camera, &again.setup.camera);
    assert_eq!(
        (ours.width, ours.height, &ours.distortion),
        (theirs.width, theirs.height, &theirs.distortion)
    );
    for (number, (ours, theirs)) in walk.reference_poses().zip(again.reference_poses()).enumerate() {
        let (ours, theirs) = (ours.unwrap(), theirs.unwrap());
        let differences = [
            ours.x_m - theirs.x_m,
            ours.y_m - theirs.y_m,
            ours.yaw_rad - theirs.yaw_rad,
            ours.height_m - theirs.height_m,
            ours.pitch_rad - theirs.pitch_rad,
            ours.roll_rad - theirs.roll_rad,
        ];
        assert!(differences.iter().all(|difference| difference.abs() < 1e-5), "{number}: {differences:?}");
    }
    // At the pose of a recorded picture, the picture is nearly that one.
    let (ours, theirs) = (walk.load_image(3).unwrap(), again.load_image(3).unwrap());
    let differences = ours.as_raw().iter().zip(theirs.as_raw()).map(|(a, b)| u64::from(a.abs_diff(*b)));
    let mean = differences.sum::<u64>() as f64 / ours.as_raw().len() as f64;
    assert!(mean < 4.0, "{mean}");
}

#[test]
fn what_cannot_be_streamed_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let (walk, database, path) = database(folder.path());
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let log = out.join("stream.mcap");
    let nobody = program(&["stream", &database, "--path", &path]);
    assert!(nobody.status.code() == Some(2) && text(&nobody.stderr).contains("give --out"));
    let far = folder.path().join("far.tum");
    let mut pose = walk.reference_poses().next().unwrap().unwrap();
    let near = StampedPose { timestamp_s: 0.0, pose };
    pose = pose.with_planar(Pose2::new(4.0, 2.5, 0.0));
    write_tum(&far, &[near, StampedPose { timestamp_s: 1.0, pose }]).unwrap();
    assert_fails(&["stream", &database, "--path", shown(&far), "--out", shown(&log)], &["far.tum, pose 2"]);
    let empty = folder.path().join("empty.tum");
    fs::write(&empty, "").unwrap();
    assert_fails(&["stream", &database, "--path", shown(&empty), "--out", shown(&log)], &["no poses"]);
    assert_fails(&["stream", &database, "--path", &path, "--out", &database], &["walk.db"]);
    assert_eq!(fs::read_dir(&out).unwrap().count(), 0);
}

#[cfg(feature = "live")]
#[test]
fn a_stream_goes_on_without_anybody_who_listens() {
    let folder = tempfile::tempdir().unwrap();
    let (_, database, path) = database(folder.path());
    let output = program(&["stream", &database, "--path", &path, "--serve", "127.0.0.1:0", "--json"]);
    let message = text(&output.stderr);
    assert!(output.status.success() && message.starts_with("open ws://127.0.0.1:"), "{message}");
}
