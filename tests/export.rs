//! `reality-sim export`, and what `tag` writes for Foxglove and Parquet.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{fs, path::Path};

use common::{assert_fails, part_of_walk, program, shown, text};
use reality_sim::{
    Sequence,
    sequence::{read_tum, write_tum},
};
use serde_json::Value;

/// Runs the program, which succeeds, and returns the JSON object that it prints.
fn report(arguments: &[&str]) -> Value {
    let output = program(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_sequence_and_the_database_of_it_give_the_same_model() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..3);
    let database = folder.path().join("walk.db");
    report(&["build", shown(&walk), "--no-hall", "--out", shown(&database)]);
    for format in ["colmap", "nerfstudio"] {
        let outs = [("sequence", shown(&walk)), ("database", shown(&database))].map(|(name, source)| {
            let out = folder.path().join(format!("{format}-{name}"));
            let report = report(&["export", source, "--format", format, "--out", shown(&out)]);
            assert_eq!((&report["pictures"], &report["format"]), (&3.into(), &format.into()));
            out
        });
        let files = ["images/000000.jpg", "images/000002.jpg"];
        let models: &[&str] = match format {
            "colmap" => {
                &["sparse/0/cameras.txt", "sparse/0/images.bin", "sparse/0/points3D.txt", "timestamps.csv"]
            }
            _ => &["transforms.json", "sparse_pc.ply"],
        };
        for file in files.iter().chain(models) {
            assert_eq!(
                fs::read(outs[0].join(file)).unwrap(),
                fs::read(outs[1].join(file)).unwrap(),
                "{format}, {file}"
            );
        }
    }
}

#[test]
fn poses_come_from_the_file_that_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..3);
    let (poses, out) = (folder.path().join("poses.tum"), folder.path().join("out.tum"));
    report(&["export", shown(&walk), "--format", "tum", "--out", shown(&poses)]);
    let mut moved = read_tum(&poses).unwrap();
    moved.pop();
    moved.iter_mut().for_each(|stamped| stamped.pose.x_m += 0.25);
    write_tum(&poses, &moved).unwrap();
    let exported =
        report(&["export", shown(&walk), "--poses", shown(&poses), "--format", "tum", "--out", shown(&out)]);
    assert_eq!((&exported["pictures"], &exported["without_pose"]), (&2.into(), &1.into()));
    let truth = Sequence::open(&walk).unwrap().frames[0].reference_pose.unwrap();
    assert!((read_tum(&out).unwrap()[0].pose.x_m - truth.x_m - 0.25).abs() < 1e-9);
}

#[test]
fn only_the_wanted_files_of_colmap_are_written_and_undistorted_pictures_have_a_pinhole() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..1);
    let out = folder.path().join("out");
    let arguments =
        ["export", shown(&walk), "--format", "colmap", "--text", "--undistort", "--border", "alpha"];
    report(&[&arguments[..], &["--fov-deg", "90", "--out", shown(&out)]].concat());
    let model = out.join("sparse/0");
    assert!(model.join("images.txt").is_file() && !model.join("images.bin").exists());
    let cameras = fs::read_to_string(model.join("cameras.txt")).unwrap();
    // At 90°, the focal length is half the width.
    assert!(cameras.lines().any(|line| line.starts_with("1 PINHOLE 640 480 320")), "{cameras}");
    let picture = image::open(out.join("images/000000.png")).unwrap();
    assert_eq!((picture.width(), picture.height(), picture.color()), (640, 480, image::ColorType::Rgba8));
}

#[test]
fn what_cannot_be_exported_is_said_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..2);
    let sequence = fs::read_to_string(walk.join("sequence.toml")).unwrap();
    let without: Vec<&str> = sequence.lines().filter(|line| !line.starts_with("groundtruth")).collect();
    fs::write(walk.join("sequence.toml"), without.join("\n")).unwrap();
    let out = folder.path().join("out");
    let colmap = ["--format", "colmap", "--out", shown(&out)];
    assert_fails(&[&["export", shown(&walk)], &colmap[..]].concat(), &["has no poses", "tag", "--poses"]);
    assert!(!out.exists());
    assert_fails(
        &["export", shown(&folder.path().join("none")), "--format", "tum", "--out", shown(&out)],
        &["no such folder"],
    );
    let frames = walk.join("frames.csv");
    assert_fails(&["export", shown(&walk), "--format", "tum", "--out", shown(&frames)], &["has no poses"]);
    let usage = program(&["export", shown(&walk), "--format", "tum", "--undistort", "--out", shown(&out)]);
    assert_eq!(usage.status.code(), Some(2));
}

#[test]
fn an_input_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..1);
    let truth = walk.join("groundtruth.tum");
    for format in ["tum", "mcap", "parquet"] {
        assert_fails(
            &["export", shown(&walk), "--format", format, "--out", shown(&truth)],
            &["is an input of this command"],
        );
    }
    assert_fails(
        &["export", shown(&walk), "--format", "colmap", "--out", shown(&walk)],
        &["holds the input"],
    );
}

fn starts_with(path: &Path, magic: &[u8]) -> bool {
    fs::read(path).unwrap().starts_with(magic)
}

#[test]
fn logs_and_tables_are_written_by_export_and_by_tag() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..2);
    let file = |name: &str| folder.path().join(name);
    report(&["export", shown(&walk), "--format", "mcap", "--out", shown(&file("export.mcap"))]);
    report(&["export", shown(&walk), "--format", "parquet", "--out", shown(&file("export.parquet"))]);
    report(&[
        "tag",
        shown(&walk),
        "--out",
        shown(&file("tag.mcap")),
        "--details",
        shown(&file("tag.parquet")),
    ]);
    report(&["tag", shown(&walk), "--smooth", "--out", shown(&file("smooth.mcap"))]);
    for name in ["export.mcap", "tag.mcap", "smooth.mcap"] {
        assert!(starts_with(&file(name), b"\x89MCAP0\r\n"), "{name}");
    }
    for name in ["export.parquet", "tag.parquet"] {
        assert!(starts_with(&file(name), b"PAR1"), "{name}");
    }
}

#[cfg(feature = "live")]
#[test]
fn tag_says_where_it_shows_its_work() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..2);
    let output = program(&["tag", shown(&walk), "--json", "--serve", "127.0.0.1:0"]);
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(message.starts_with("open ws://127.0.0.1:") && message.lines().count() == 1, "{message}");
    assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok());
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    assert_fails(&["tag", shown(&walk), "--serve", &address], &[&address, "another address or port"]);
}

#[cfg(unix)]
#[test]
fn a_log_replaces_no_device_and_follows_links() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..1);
    let (device, link) = (folder.path().join("device.mcap"), folder.path().join("link.mcap"));
    symlink("/dev/null", &device).unwrap();
    assert_fails(
        &["export", shown(&walk), "--format", "mcap", "--out", shown(&device)],
        &["not a regular file"],
    );
    assert!(fs::metadata(&device).unwrap().file_type().is_char_device());
    fs::write(folder.path().join("file.mcap"), "old").unwrap();
    symlink("file.mcap", &link).unwrap();
    report(&["export", shown(&walk), "--format", "mcap", "--out", shown(&link)]);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(starts_with(&folder.path().join("file.mcap"), b"\x89MCAP0\r\n"));
}

#[cfg(all(unix, feature = "live"))]
#[test]
fn an_interrupted_log_leaves_nothing_behind() {
    use std::{
        io::{BufRead, BufReader},
        process::{Command, Stdio},
    };
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "walk", 0..1);
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    // It waits for a client that does not come.
    let mut waiting = Command::new(env!("CARGO_BIN_EXE_reality-sim"))
        .args(["tag", shown(&walk), "--serve", "127.0.0.1:0", "--serve-wait", "--out"])
        .arg(out.join("walk.mcap"))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(waiting.stderr.take().unwrap()).lines();
    assert!(lines.next().unwrap().unwrap().starts_with("open ws://"));
    assert_eq!(fs::read_dir(&out).unwrap().count(), 1, "the log has been begun");
    let pid = waiting.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    assert_eq!(waiting.wait().unwrap().code(), Some(130));
    assert_eq!(lines.next().unwrap().unwrap(), "error: interrupted");
    assert_eq!(fs::read_dir(&out).unwrap().count(), 0);
}
