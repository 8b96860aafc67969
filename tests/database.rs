//! `build`, `info`, `render` and `evaluate`, run as users run them, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    sync::OnceLock,
};

use image::RgbImage;
use reality_sim::{Sequence, db::Database, sequence::save_image, write_tum};
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

/// Exit code 1, one line on standard error with all these words, nothing on standard output.
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

/// The walk's text files in a folder of their own with these frames; the pictures are linked.
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

/// A database of the walk's first 40 pictures, and its other 20 as probes.
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

#[test]
fn a_walk_is_stored_once_however_often_it_is_built() {
    let (folder, ..) = demonstration();
    let own = tempfile::tempdir().unwrap();
    let copy = copy_of_database(own.path());
    let walk = folder.path().join("recorded");
    let report = json(&["build", shown(&walk), "--out", shown(&copy)]);
    assert_eq!(report["sequences"][0]["added"], 0);
    assert_eq!(report["sequences"][0]["already_there"], 40);
    assert_eq!(report["sequences"][0]["poses"], "groundtruth");
    assert_eq!(report["images"], 40);
}

#[test]
fn poses_come_from_the_file_given_or_from_the_filter() {
    let own = tempfile::tempdir().unwrap();
    let walk = part_of_walk(own.path(), "walk", 0..12);
    let poses = own.path().join("poses.tum");
    let tagged = program(&["tag", shown(&walk), "--out", shown(&poses)]);
    assert!(tagged.status.success());
    let by_file = own.path().join("file.db");
    let report = json(&["build", shown(&walk), "--out", shown(&by_file), "--poses", shown(&poses)]);
    assert_eq!((&report["sequences"][0]["poses"], &report["images"]), (&"file".into(), &12.into()));

    let by_filter = own.path().join("filter.db");
    let report = json(&["build", shown(&walk), "--out", shown(&by_filter), "--tag", "--seed", "5"]);
    assert_eq!(report["sequences"][0]["poses"], "filter");
    let database = Database::open(&by_filter).unwrap();
    let images = database.images().unwrap();
    let truth: Vec<_> = Sequence::open(&walk).unwrap().reference_poses().collect();
    assert!(images.len() > 8, "{} sure", images.len());
    for image in images {
        let truth = truth[image.frame_index].unwrap();
        assert!((image.pose.x_m - truth.x_m).hypot(image.pose.y_m - truth.y_m) < 0.02);
        let sigma_m = image.covariance.unwrap()[(0, 0)].sqrt();
        assert!((1e-6..0.05).contains(&sigma_m), "{sigma_m}");
    }
    let report = json(&["info", shown(&by_filter)]);
    let settings: Value =
        serde_json::from_str(report["pose_sources"][0]["description"].as_str().unwrap()).unwrap();
    assert_eq!((&settings["seed"], &settings["observation"]), (&5.into(), &"contrast".into()));
}

#[test]
fn info_counts_and_draws_what_is_there() {
    let own = tempfile::tempdir().unwrap();
    let chart = own.path().join("coverage.svg");
    let (_, database, _) = demonstration();
    let report = json(&["info", shown(database), "--coverage", shown(&chart)]);
    assert_eq!(report["images"], 40);
    assert_eq!(report["sequences"][0]["name"], "recorded");
    assert_eq!(report["cameras"][0]["model"], "OPENCV_FISHEYE");
    let near = report["coverage"]["near"].as_f64().unwrap();
    assert!((0.001..0.2).contains(&near), "{near}");
    let svg = fs::read_to_string(&chart).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    let people = program(&["info", shown(database)]);
    assert!(text(&people.stdout).contains("40 pictures"));
}

#[test]
fn every_method_gives_a_picture_at_a_pose() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    for method in ["nearest", "quadratic", "plane", "blend", "simulated"] {
        let out = own.path().join(format!("{method}.png"));
        let report = json(&[
            "render",
            shown(database),
            "--pose",
            "-2.05,0.9,1.6",
            "--method",
            method,
            "--out",
            shown(&out),
        ]);
        assert_eq!(report["method"], method);
        assert_eq!(image::open(&out).unwrap().into_rgb8().dimensions(), (640, 480));
    }
    let [origins, trust, out] = ["origins.png", "trust.png", "out.jpg"].map(|name| own.path().join(name));
    let report = json(&[
        "render",
        shown(database),
        "--pose",
        "-2.05,0.9,1.6,0.52,0.4,0.0",
        "--origins",
        shown(&origins),
        "--trust",
        shown(&trust),
        "--out",
        shown(&out),
        "--neighbours",
        "3",
    ]);
    assert_eq!(report["used"].as_array().unwrap().len(), 3);
    assert!(report["covered"].as_f64().unwrap() > 0.8);
    assert!(origins.exists() && trust.exists() && out.exists());
}

#[test]
fn a_path_becomes_a_sequence_of_pictures_and_a_strip() {
    let own = tempfile::tempdir().unwrap();
    let (folder, database, _) = demonstration();
    let [pictures, strip] = ["pictures", "strip.jpg"].map(|name| own.path().join(name));
    let path = folder.path().join("probes").join("groundtruth.tum");
    let report = json(&[
        "render",
        shown(database),
        "--path",
        shown(&path),
        "--out",
        shown(&pictures),
        "--strip",
        shown(&strip),
        "--method",
        "plane",
    ]);
    assert_eq!(report["pictures"], 20);
    assert_eq!(fs::read_dir(&pictures).unwrap().count(), 20);
    assert!(pictures.join("000019.png").exists());
    let strip = image::open(&strip).unwrap();
    assert!(strip.width() > 1200 && strip.height() > 400, "two rows of four");
}

#[test]
fn reconstructions_are_nearer_to_the_truth_than_the_nearest_picture() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, probes) = demonstration();
    let [details, pictures] = ["details.csv", "pictures"].map(|name| own.path().join(name));
    let report = json(&[
        "evaluate",
        shown(database),
        shown(probes),
        "--details",
        shown(&details),
        "--pictures",
        shown(&pictures),
    ]);
    let field = |method: &str| report["methods"][method]["psnr_field_db"].as_f64().unwrap();
    let ssim = |method: &str| report["methods"][method]["ssim"].as_f64().unwrap();
    assert!(field("plane") > field("nearest") + 5.5, "{report:#}");
    assert!(field("plane") > field("quadratic") + 2.0, "{report:#}");
    assert!(field("blend") > field("nearest") + 8.0 && ssim("blend") > ssim("nearest") + 0.1, "{report:#}");
    for method in ["nearest", "quadratic", "plane", "blend"] {
        assert_eq!(report["methods"][method]["answered"], 1.0);
        assert!(report["methods"][method]["milliseconds"].as_f64().unwrap() > 0.0);
        assert!(report["methods"][method]["psnr_db"].as_f64().unwrap() > 5.0);
    }
    let rows = fs::read_to_string(&details).unwrap();
    assert_eq!(rows.lines().count(), 1 + 20 * 5);
    assert_eq!(fs::read_dir(&pictures).unwrap().count(), 20);
}

#[cfg(feature = "gpu")]
#[test]
fn drawing_on_the_graphics_device_gives_the_same_picture() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    let [cpu, gpu] = ["cpu", "gpu"].map(|backend| {
        let out = own.path().join(format!("{backend}.png"));
        json(&[
            "render",
            shown(database),
            "--pose",
            "-2.05,0.9,1.6",
            "--backend",
            backend,
            "--out",
            shown(&out),
        ]);
        image::open(&out).unwrap().into_rgb8()
    });
    let different = cpu.iter().zip(gpu.iter()).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    assert!(different < cpu.len() / 500, "{different} of {}", cpu.len());
}

#[test]
fn what_is_no_database_is_named() {
    let own = tempfile::tempdir().unwrap();
    let missing = own.path().join("missing.db");
    let (other, cut) = (own.path().join("notes.txt"), copy_of_database(own.path()));
    fs::write(&other, "these are notes, and no database at all").unwrap();
    let bytes = fs::read(&cut).unwrap();
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let out = own.path().join("out.png");
    let probes = &demonstration().2;
    for (file, word) in [(&missing, "missing.db"), (&other, "notes.txt"), (&cut, "build it again")] {
        let file = shown(file);
        assert_fails(&["info", file], &[word]);
        assert_fails(&["render", file, "--pose", "0,0,0", "--out", shown(&out)], &[word]);
        assert_fails(&["evaluate", file, shown(probes)], &[word]);
    }
    assert_fails(&["build", WALK, "--out", shown(&other)], &["notes.txt"]);
    assert_eq!(fs::read_to_string(&other).unwrap(), "these are notes, and no database at all");
    assert!(!out.exists());
}

#[test]
fn poses_without_pictures_near_them_are_refused_in_one_line() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    let out = own.path().join("out.png");
    let render = |pose: &'static str| ["render", shown(database), "--pose", pose, "--out", shown(&out)];
    assert_fails(&render("40,0,0"), &["40.00 m", "record pictures there"]);
    assert_fails(&render("2.9,-1.9,-1.5"), &["record pictures there"]);
    assert_fails(&render("0,0,0,-1,0,0"), &["above the ground"]);
    assert!(!out.exists());
    let eager = program(&[&render("2.9,-1.9,-1.5")[..], &["--best-effort"]].concat());
    assert!(eager.status.success() && out.exists());
}

#[test]
fn outputs_without_a_place_and_inputs_in_the_way_are_refused() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, probes) = demonstration();
    let nowhere = own.path().join("no/such/folder/out.png");
    assert_fails(
        &["render", shown(database), "--pose", "-2,1,1.5", "--out", shown(&nowhere)],
        &["no such folder"],
    );
    assert_fails(&["build", WALK, "--out", shown(own.path())], &["is a folder"]);
    let copy = copy_of_database(own.path());
    let svg = own.path().join("copy.svg");
    fs::copy(&copy, &svg).unwrap();
    assert_fails(&["info", shown(&svg), "--coverage", shown(&svg)], &["is an input"]);
    let csv = probes.join("frames.csv");
    assert_fails(&["evaluate", shown(database), shown(probes), "--details", shown(&csv)], &["is an input"]);
    let [text, same] = ["out.txt", "same.png"].map(|name| own.path().join(name));
    let render = ["render", shown(database), "--pose", "-2,1,1.5", "--out"];
    assert_fails(&[&render[..], &[shown(&text)]].concat(), &["out.txt", ".png"]);
    assert_fails(&[&render[..], &[shown(&same), "--trust", shown(&same)]].concat(), &["two outputs"]);
    assert!(!same.exists());
    let chart = own.path().join("coverage.png");
    assert_fails(&["info", shown(&copy), "--coverage", shown(&chart)], &["coverage.png", ".svg"]);
    assert_fails(&["evaluate", shown(database), shown(own.path())], &["sequence.toml"]);
}

#[test]
fn recordings_that_cannot_be_stored_are_named_and_lose_nothing() {
    let own = tempfile::tempdir().unwrap();
    let out = own.path().join("out.db");
    let walk = part_of_walk(own.path(), "walk", 0..6);
    let cut = walk.join("images/000004.jpg");
    let bytes = fs::read(&cut).unwrap();
    fs::write(&cut, &bytes[..bytes.len() / 3]).unwrap();
    assert_fails(&["build", shown(&walk), "--out", shown(&out)], &["000004.jpg"]);
    fs::write(&cut, &bytes).unwrap();
    let report = json(&["build", shown(&walk), "--out", shown(&out)]);
    assert_eq!(report["images"], 6);

    let poses = own.path().join("poses.tum");
    fs::write(&poses, "1.0 0 0 NaN 0 0 0 1\n").unwrap();
    assert_fails(
        &["build", shown(&walk), "--out", shown(&out), "--poses", shown(&poses)],
        &["poses.tum, line 1"],
    );
    let elsewhere = [reality_sim::StampedPose { timestamp_s: 1e6, pose: Default::default() }];
    write_tum(&poses, &elsewhere).unwrap();
    assert_fails(&["build", shown(&walk), "--out", shown(&out), "--poses", shown(&poses)], &["poses.tum"]);
    assert_eq!(Database::open(&out).unwrap().images().unwrap().len(), 6);
}

#[test]
fn a_build_that_was_killed_goes_on_where_it_was() {
    const FRAMES: usize = 2000;
    let own = tempfile::tempdir().unwrap();
    let out = own.path().join("out.db");
    // Enough pictures for several transactions.
    let mut walk = Sequence::open(Path::new(WALK)).unwrap();
    let folder = own.path().join("long");
    let picture = walk.load_image(0).unwrap();
    let frame = walk.frames[0].clone();
    walk.frames.clear();
    for number in 0..FRAMES {
        let image = PathBuf::from(format!("{number:06}.jpg"));
        let source = folder.join("000000.jpg");
        if number == 0 {
            save_image(&source, &picture).unwrap();
        } else {
            fs::hard_link(&source, folder.join(&image)).unwrap();
        }
        walk.frames.push(reality_sim::sequence::FrameRecord {
            timestamp_s: number as f64,
            image,
            ..frame.clone()
        });
    }
    walk.write(&folder).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_reality-sim"))
        .args(["build", shown(&folder), "--out", shown(&out), "--no-hall"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // Killed once something was committed.
    while child.try_wait().unwrap().is_none() {
        if Database::open(&out).and_then(|database| database.images()).is_ok_and(|images| !images.is_empty())
        {
            child.kill().unwrap();
            child.wait().unwrap();
        }
    }
    let committed = Database::open(&out).unwrap().images().unwrap().len();
    assert!((1..FRAMES).contains(&committed), "{committed}");
    let report = json(&["build", shown(&folder), "--out", shown(&out), "--no-hall"]);
    assert_eq!(report["sequences"][0]["already_there"], committed);
    assert_eq!(report["images"], FRAMES);
}

#[test]
fn poses_that_no_camera_can_have_are_refused_before_anything_is_stored() {
    let own = tempfile::tempdir().unwrap();
    let walk = part_of_walk(own.path(), "walk", 0..4);
    let out = own.path().join("out.db");
    for absurd in ["0 0 -0.5", "1e6 0 0.5", "1e200 0 0.5"] {
        let rows: Vec<String> = fs::read_to_string(walk.join("groundtruth.tum"))
            .unwrap()
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(|line| {
                let fields: Vec<&str> = line.split(' ').collect();
                format!("{} {absurd} {}\n", fields[0], fields[4..].join(" "))
            })
            .collect();
        let poses = own.path().join("poses.tum");
        fs::write(&poses, rows.concat()).unwrap();
        assert_fails(
            &["build", shown(&walk), "--out", shown(&out), "--poses", shown(&poses)],
            &["frame 0", "above the ground"],
        );
    }
    let missing = own.path().join("missing.tum");
    let untouched = own.path().join("untouched.db");
    assert_fails(
        &["build", shown(&walk), "--out", shown(&untouched), "--poses", shown(&missing)],
        &["missing.tum"],
    );
    assert!(!untouched.exists());
}

/// One picture, and a robot that stood still and turned: no triangulation, and pictures all the same.
#[test]
fn the_smallest_databases_give_pictures() {
    let own = tempfile::tempdir().unwrap();
    let one = part_of_walk(own.path(), "one", 0..1);
    let mut still = Sequence::open(&part_of_walk(own.path(), "still", 0..12)).unwrap();
    for (index, frame) in still.frames.iter_mut().enumerate() {
        let planar = reality_sim::Pose2::new(0.1, 0.2, 0.5 * index as f64);
        frame.reference_pose = frame.reference_pose.map(|pose| pose.with_planar(planar));
    }
    still.write(&still.folder).unwrap();
    let at = Sequence::open(&one).unwrap().frames[0].reference_pose.unwrap();
    for (sequence, pose) in
        [(one, format!("{},{},0.6", at.x_m, at.y_m)), (still.folder, "0.1,0.2,0.7".to_owned())]
    {
        let database = sequence.with_extension("db");
        let report = json(&["build", shown(&sequence), "--out", shown(&database)]);
        assert!(report.get("hall").is_none(), "one place does not tell where walls are: {report}");
        for method in ["nearest", "plane", "blend", "auto"] {
            let out = own.path().join("out.png");
            json(&[
                "render",
                shown(&database),
                "--pose",
                &pose,
                "--method",
                method,
                "--out",
                shown(&out),
                "--best-effort",
            ]);
        }
        json(&["info", shown(&database)]);
    }
}

#[test]
fn a_picture_is_black_where_the_lens_leaves_it_black_and_that_does_not_count() {
    let own = tempfile::tempdir().unwrap();
    let walk = part_of_walk(own.path(), "walk", 0..20);
    let file = walk.join("camera.toml");
    let camera = fs::read_to_string(&file).unwrap();
    let circle = "image_circle = { cx = 319.5, cy = 239.5, radius = 185.0 }\n";
    fs::write(&file, format!("{circle}{camera}")).unwrap();
    let database = own.path().join("walk.db");
    json(&["build", shown(&walk), "--out", shown(&database)]);
    for method in ["quadratic", "plane", "blend"] {
        let out = own.path().join("out.png");
        let report = json(&[
            "render",
            shown(&database),
            "--pose=-1.8,0.35,2.1",
            "--method",
            method,
            "--out",
            shown(&out),
            "--best-effort",
        ]);
        let picture = image::open(&out).unwrap().into_rgb8();
        for corner in [(2, 2), (637, 2), (2, 477), (637, 477), (319, 40)] {
            assert_eq!(picture.get_pixel(corner.0, corner.1).0, [0; 3], "{method} {corner:?}");
        }
        assert!(report["covered"].as_f64().unwrap() > 0.6, "{method} {report}");
    }
}

#[test]
fn another_lens_is_drawn_and_another_size_has_no_nearest_picture() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    let (camera, out) = (own.path().join("camera.toml"), own.path().join("out.png"));
    let lens = "model = 'PINHOLE'\nwidth = 200\nheight = 120\nfx = 120.0\nfy = 120.0\ncx = 99.5\ncy = 59.5\ndistortion = []\n";
    fs::write(&camera, format!("{lens}[mount]\nheight_m = 0.5\n")).unwrap();
    let render = |method: &'static str| {
        [
            "render",
            shown(database),
            "--pose",
            "-2.05,0.9,1.6",
            "--method",
            method,
            "--camera",
            shown(&camera),
            "--out",
            shown(&out),
        ]
    };
    for method in ["plane", "blend", "auto", "simulated"] {
        json(&render(method));
        assert_eq!(image::open(&out).unwrap().into_rgb8().dimensions(), (200, 120), "{method}");
    }
    assert_fails(&render("nearest"), &["200 x 120"]);
}

/// The simulated picture at a pose, with a model in the folder.
fn simulated(folder: &Path, model: &str) -> RgbImage {
    let (_, database, _) = demonstration();
    let (file, out) = (folder.join("model.toml"), folder.join("out.png"));
    fs::write(&file, model).unwrap();
    let [database, model, picture] = [database, &file, &out].map(|path| shown(path));
    let arguments = ["render", database, "--pose", "-2.05,0.9,1.6", "--method", "simulated"];
    json(&[&arguments[..], &["--model", model, "--out", picture]].concat());
    image::open(&out).unwrap().into_rgb8()
}

#[test]
fn a_model_changes_the_simulated_picture_as_its_effects_say() {
    let own = tempfile::tempdir().unwrap();
    let nominal = simulated(own.path(), "");
    let dark = simulated(own.path(), "[[effect]]\nid = 'vignetting'\nstrength = 0.5\n");
    let still = simulated(own.path(), "[[effect]]\nid = 'rolling_shutter'\nreadout_s = 0.05\n");
    assert!(nominal == still, "nothing moves at a single pose");
    let brightness = |picture: &RgbImage, u, v| picture.get_pixel(u, v).0.map(u32::from).iter().sum::<u32>();
    assert!(brightness(&dark, 2, 477) < brightness(&nominal, 2, 477) * 4 / 5);
    assert!(brightness(&dark, 320, 240).abs_diff(brightness(&nominal, 320, 240)) < 5);
}

#[test]
fn along_a_path_the_simulated_camera_moves() {
    let own = tempfile::tempdir().unwrap();
    let (folder, database, _) = demonstration();
    let path = folder.path().join("probes").join("groundtruth.tum");
    let model = own.path().join("model.toml");
    let pictures = ["nominal", "rolling"].map(|name| {
        let readout_s = if name == "rolling" { 0.06 } else { 0.0 };
        fs::write(&model, format!("[[effect]]\nid = 'rolling_shutter'\nreadout_s = {readout_s}\n")).unwrap();
        let out = own.path().join(name);
        let [database, path, model, out] = [database, &path, &model, &out].map(|path| shown(path));
        let arguments = ["render", database, "--path", path, "--method", "simulated", "--model", model];
        assert_eq!(json(&[&arguments[..], &["--out", out]].concat())["pictures"], 20);
        image::open(Path::new(out).join("000007.png")).unwrap().into_rgb8()
    });
    assert!(pictures[0] != pictures[1]);
}

#[test]
fn a_model_or_path_that_cannot_be_used_is_named() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    let [model, path, out] = ["model.toml", "path.tum", "out"].map(|name| own.path().join(name));
    let fails = |text: &str, expected: &[&str]| {
        fs::write(&model, text).unwrap();
        let [database, model, path, out] = [database, &model, &path, &out].map(|path| shown(path));
        let arguments = ["render", database, "--path", path, "--method", "simulated", "--model", model];
        assert_fails(&[&arguments[..], &["--out", out]].concat(), expected);
    };
    fs::write(&path, "0 1 0 0.5 0 0 0 1\n0.2 1 0 0.5 0 0 0 1\n").unwrap();
    fails("[[effect]]\nid = 'fog'\n", &["model.toml, line 2", "fog", "vignetting"]);
    fails("[[effect]]\nid = 'focal_length'\nscale = -2.0\n", &["model.toml", "focal_length"]);
    fs::write(&path, "1 1 0 0.5 0 0 0 1\n0.2 1 0 0.5 0 0 0 1\n").unwrap();
    fails("", &["path.tum", "does not follow", "sort"]);
}

#[test]
fn wrong_usage_exits_with_2() {
    let (folder, database, _) = demonstration();
    let database = shown(database);
    for arguments in [
        &["build", "--out", "x.db"][..],
        &["build", WALK],
        &["build", WALK, WALK, "--out", "x.db", "--poses", "p.tum"],
        &["build", WALK, "--out", "x.db", "--poses", "p.tum", "--tag"],
        &["render", database, "--out", "x.png"],
        &["render", database, "--pose", "1,2", "--out", "x.png"],
        &["render", database, "--pose", "1,2,NaN", "--out", "x.png"],
        &["render", database, "--pose", "1,2,3", "--path", "p.tum", "--out", "x.png"],
        &["render", database, "--pose", "1,2,3", "--method", "magic", "--out", "x.png"],
        &[
            "render",
            database,
            "--pose",
            "1,2,3",
            "--method",
            "simulated",
            "--trust",
            "t.png",
            "--out",
            "x.png",
        ],
        &["render", database, "--pose", "1,2,3", "--model", "m.toml", "--out", "x.png"],
        &["render", database, "--pose", "1,2,3", "--method", "blend", "--model", "m.toml", "--out", "x.png"],
        &["render", database, "--pose", "1,2,3", "--neighbours", "9", "--out", "x.png"],
        &["evaluate", database],
        &["info"],
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_reality-sim"))
            .current_dir(folder)
            .args(arguments)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
    }
}
