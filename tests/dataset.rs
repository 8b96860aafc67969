//! `dataset`, run as users run it, on a part of the demonstration walk: complete, interrupted, and in places where it must not write.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::OnceLock,
};

use serde_json::Value;
use tempfile::TempDir;

use common::{assert_fails, part_of_walk, program, shown, text};

const COUNT: usize = 5;

fn json(arguments: &[&str]) -> Value {
    let output = program(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "nothing is shown in a pipe: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Makes a database of a part of the walk, and a data set of it.
fn made() -> &'static (TempDir, PathBuf, PathBuf) {
    static MADE: OnceLock<(TempDir, PathBuf, PathBuf)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let walk = part_of_walk(folder.path(), "recorded", 0..20);
        let [database, out] = ["walk.db", "whole"].map(|name| folder.path().join(name));
        json(&["build", shown(&walk), "--out", shown(&database), "--no-hall"]);
        let report = json(&dataset(&database, &out, "5"));
        assert_eq!(report["pictures"], COUNT);
        assert_eq!(report["written"], COUNT);
        assert_eq!(report["skipped"], 0);
        assert!(report["pictures_per_second"].as_f64().unwrap() > 0.0);
        assert_eq!(report["out"], shown(&out));
        (folder, database, out)
    })
}

fn dataset<'a>(database: &'a Path, out: &'a Path, count: &'a str) -> Vec<&'a str> {
    let options =
        ["--seed", "4", "--balls", "1..2", "--robots", "1", "--depth", "--trust", "--backend", "cpu"];
    [&["dataset", shown(database), "--out", shown(out), "--count", count], &options[..]].concat()
}

/// Returns the relative paths of all files in a folder with their bytes.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(inner) = open.pop() {
        for path in fs::read_dir(inner).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                open.push(path);
            } else {
                found.push((path.strip_prefix(folder).unwrap().to_path_buf(), fs::read(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

/// Asserts that two folders hold the same files, but for those that a killed program was writing.
fn assert_same(one: &Path, other: &Path) {
    let [one, other] = [one, other].map(|folder| {
        let mut files = files(folder);
        files.retain(|(path, _)| !path.to_str().unwrap().contains(".unfinished-"));
        files
    });
    let names = |files: &[(PathBuf, Vec<u8>)]| files.iter().map(|(path, _)| path.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one), names(&other));
    for ((path, one), (_, other)) in one.iter().zip(&other) {
        assert!(one == other, "{} differs", path.display());
    }
}

fn annotations(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("annotations.json")).unwrap()).unwrap()
}

#[test]
fn annotations_are_whole_and_fit_their_pictures() {
    let (_, _, out) = made();
    let set = annotations(out);
    let categories: BTreeSet<u64> = set["categories"]
        .as_array()
        .unwrap()
        .iter()
        .map(|category| category["id"].as_u64().unwrap())
        .collect();
    assert_eq!(categories, BTreeSet::from([1, 2, 3, 4, 5, 100]));
    let images = set["images"].as_array().unwrap();
    assert_eq!(images.len(), COUNT);
    let mut ids = BTreeSet::new();
    let mut things = BTreeSet::new();
    for (number, image) in images.iter().enumerate() {
        assert_eq!(image["id"], number);
        let picture = image::open(out.join("images").join(image["file_name"].as_str().unwrap())).unwrap();
        let mask = image::open(out.join("masks").join(image["mask"].as_str().unwrap())).unwrap().into_luma8();
        let depth =
            image::open(out.join("depth").join(image["depth"].as_str().unwrap())).unwrap().into_luma16();
        assert_eq!((picture.width(), picture.height()), (640, 480));
        assert_eq!((mask.dimensions(), depth.dimensions()), ((640, 480), (640, 480)));
        let trust =
            image::open(out.join("trust").join(image["trust"].as_str().unwrap())).unwrap().into_luma8();
        let mean = trust.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / (255.0 * 640.0 * 480.0);
        assert!((mean - image["trust_mean"].as_f64().unwrap()).abs() < 1e-3, "the lens lights every pixel");
        assert!(image["covered"].as_f64().unwrap() >= 0.4);
        assert!((0.0..=1.0).contains(&image["trust_mean"].as_f64().unwrap()));
        let height_m = image["pose"]["height_m"].as_f64().unwrap();
        let nearest_mm = depth.pixels().map(|pixel| f64::from(pixel.0[0])).fold(f64::INFINITY, f64::min);
        assert!(nearest_mm > 0.0 && nearest_mm < 3000.0 * height_m, "the ground below is near");
        let of_image = set["annotations"].as_array().unwrap().iter();
        for annotation in of_image.filter(|annotation| annotation["image_id"] == number) {
            assert!(ids.insert(annotation["id"].as_u64().unwrap()), "every id is used once");
            let category = annotation["category_id"].as_u64().unwrap();
            assert!(categories.contains(&category));
            if category == 1 || category == 2 {
                let pixels = mask.pixels().filter(|pixel| u64::from(pixel.0[0]) == category).count();
                assert_eq!(annotation["area"], pixels);
            }
            things.extend(annotation["name"].as_str().map(str::to_owned));
        }
    }
    assert_eq!(ids.len(), set["annotations"].as_array().unwrap().len());
    assert!(things.contains("ball_1") && things.contains("robot_1"), "{things:?}");
}

#[test]
fn pictures_depend_on_seed_and_number_alone() {
    let (folder, database, whole) = made();
    // On one thread, and with fewer pictures first.
    let other = folder.path().join("other");
    for (count, written) in [("2", 2), ("5", 3), ("5", 0)] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_reality-sim"));
        command.args(dataset(database, &other, count)).arg("--json").env("RAYON_NUM_THREADS", "1");
        let output = command.output().unwrap();
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["written"], written, "{}", text(&output.stderr));
        assert_eq!(report["skipped"].as_i64().unwrap() + written, count.parse::<i64>().unwrap());
    }
    assert_same(whole, &other);
    let seed = folder.path().join("seed");
    json(&[
        "dataset",
        shown(database),
        "--out",
        shown(&seed),
        "--count",
        "1",
        "--seed",
        "5",
        "--backend",
        "cpu",
    ]);
    let pose = |folder: &Path| annotations(folder)["images"][0]["pose"].clone();
    assert_ne!(pose(&seed), pose(whole));
}

/// Starts a run and stops it by a signal once so many pictures are done.
#[cfg(unix)]
fn interrupted(database: &Path, out: &Path, signal: &str, done: usize) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_reality-sim"));
    command.args(dataset(database, out, "5")).stdout(Stdio::null()).stderr(Stdio::null());
    let mut running = command.spawn().unwrap();
    // Files that are being written have other endings.
    let is_record = |entry: &io::Result<fs::DirEntry>| {
        entry.as_ref().is_ok_and(|entry| entry.path().extension().is_some_and(|ending| ending == "jsonl"))
    };
    let records = || fs::read_dir(out.join("annotations")).map_or(0, |found| found.filter(is_record).count());
    while records() < done && running.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    // The run may have ended meanwhile.
    let _ = Command::new("kill").args([signal, &running.id().to_string()]).stderr(Stdio::null()).status();
    running.wait().unwrap();
}

#[cfg(unix)]
#[test]
fn a_run_that_was_interrupted_is_completed_as_if_it_had_not_been() {
    let (folder, database, whole) = made();
    for (signal, done) in [("-KILL", 1), ("-INT", 2)] {
        let out = folder.path().join(format!("interrupted{signal}"));
        interrupted(database, &out, signal, done);
        for (path, bytes) in files(&out) {
            let name = path.to_str().unwrap();
            assert!(signal == "-KILL" || !name.contains(".unfinished-"), "{name}");
            if name.ends_with(".jpg") || (name.ends_with(".png") && !name.contains(".unfinished-")) {
                image::load_from_memory(&bytes).unwrap();
            }
        }
        let report = json(&dataset(database, &out, "5"));
        assert!(report["skipped"].as_u64().unwrap() >= done as u64, "{signal}: {report}");
        assert_same(whole, &out);
    }
}

#[test]
fn a_file_that_is_lost_is_made_again() {
    let (folder, database, whole) = made();
    let out = folder.path().join("lost");
    for (path, bytes) in files(whole) {
        fs::create_dir_all(out.join(&path).parent().unwrap()).unwrap();
        fs::write(out.join(path), bytes).unwrap();
    }
    fs::remove_file(out.join("masks/000003.png")).unwrap();
    fs::remove_file(out.join("annotations.json")).unwrap();
    assert_eq!(json(&dataset(database, &out, "5"))["written"], 1);
    assert_same(whole, &out);
}

#[test]
fn a_folder_of_something_else_is_left_alone() {
    let (folder, database, whole) = made();
    let before = files(whole);
    assert_fails(&dataset(database, whole, "3"), &["whole", "more than 3 pictures", "--count"]);
    let other = [&dataset(database, whole, "5")[..], &["--within", "99"]].concat();
    assert_fails(&other, &["whole", "within_px", "another folder"]);
    fs::write(folder.path().join("file.txt"), "mine").unwrap();
    assert_fails(&dataset(database, folder.path(), "5"), &["holds the input", "walk.db"]);
    let foreign = folder.path().join("foreign");
    fs::create_dir(&foreign).unwrap();
    fs::write(foreign.join("notes.txt"), "mine").unwrap();
    assert_fails(&dataset(database, &foreign, "5"), &["foreign", "other files", "new folder"]);
    assert_eq!(files(&foreign).len(), 1);
    let spoiled = folder.path().join("spoiled");
    fs::create_dir(&spoiled).unwrap();
    fs::write(spoiled.join("dataset.json"), "[1").unwrap();
    assert_fails(&dataset(database, &spoiled, "5"), &["dataset.json", "manifest"]);
    assert!(files(whole) == before);
}

#[test]
fn nothing_is_created_where_nothing_can_be_made() {
    let (folder, database, _) = made();
    let out = folder.path().join("nothing/here");
    let missing = folder.path().join("missing.db");
    assert_fails(&dataset(&missing, &out, "5"), &["missing.db"]);
    assert!(!missing.exists());
    let not_one = folder.path().join("text.db");
    fs::write(&not_one, "no database").unwrap();
    assert_fails(&dataset(&not_one, &out, "5"), &["text.db"]);
    let far = [&dataset(database, &out, "5")[..], &["--within", "0.001"]].concat();
    assert_fails(&far, &["walk.db", "0.001 px", "--within"]);
    assert!(!folder.path().join("nothing").exists());
    for out in ["/dev/null", "/dev/null/folder"] {
        assert_fails(&dataset(database, Path::new(out), "5"), &[out]);
    }
    for (option, value) in [
        ("--count", "0"),
        ("--balls", "3..1"),
        ("--robots", "51"),
        ("--method", "nearest"),
        ("--within", "0"),
    ] {
        let fine = dataset(database, &out, "5").into_iter().filter(|word| *word != "1");
        let mut arguments: Vec<&str> = fine.collect();
        arguments.retain(|word| {
            !["--robots", "--count", "5"].contains(word) && !["--balls", "1..2"].contains(word)
        });
        if option != "--count" {
            arguments.extend(["--count", "5"]);
        }
        arguments.extend([option, value]);
        let output = program(&arguments);
        assert_eq!(output.status.code(), Some(2), "{option} {value}: {}", text(&output.stderr));
    }
    assert!(!folder.path().join("nothing").exists());
}
