//! Storage of recordings by `build`, and the summary of `info`.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use reality_sim::{Sequence, db::Database, sequence::save_image, write_tum};
use serde_json::Value;

use super::{WALK, assert_fails, copy_of_database, demonstration, json, part_of_walk, program, shown, text};

#[test]
fn building_again_stores_nothing_twice() {
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
    let output = program(&["tag", shown(&walk), "--out", shown(&poses)]);
    assert!(output.status.success());
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
    for image in &images {
        let truth = truth[image.frame_index].unwrap();
        assert!((image.pose.x_m - truth.x_m).hypot(image.pose.y_m - truth.y_m) < 0.02);
    }
    let mut sigmas_m = Vec::new();
    database.each_image(|_, details| sigmas_m.push(details.covariance.unwrap()[(0, 0)].sqrt())).unwrap();
    assert_eq!(sigmas_m.len(), images.len());
    assert!(sigmas_m.iter().all(|sigma_m| (1e-6..0.05).contains(sigma_m)), "{sigmas_m:?}");
    let report = json(&["info", shown(&by_filter)]);
    let settings: Value =
        serde_json::from_str(report["pose_sources"][0]["description"].as_str().unwrap()).unwrap();
    assert_eq!((&settings["seed"], &settings["observation"]), (&5.into(), &"contrast".into()));
}

#[test]
fn databases_are_merged_and_split_by_field() {
    let own = tempfile::tempdir().unwrap();
    let [a, b, both, parts] = ["a.db", "b.db", "both.db", "parts"].map(|name| own.path().join(name));
    let walk = part_of_walk(own.path(), "here", 0..12);
    let elsewhere = part_of_walk(own.path(), "there", 12..20);
    let field = elsewhere.join("field.toml");
    let text = fs::read_to_string(&field).unwrap();
    let renamed: Vec<&str> = text.lines().filter(|line| !line.starts_with("name")).collect();
    fs::write(&field, format!("name = \"Hall 2\"\n{}\n", renamed.join("\n"))).unwrap();
    for (recording, database) in [(&walk, &a), (&elsewhere, &b)] {
        json(&["build", shown(recording), "--out", shown(database)]);
    }
    let report = json(&["build", shown(&a), shown(&b), "--out", shown(&both)]);
    assert_eq!((&report["images"], &report["databases"][1]["added"]), (&20.into(), &8.into()));
    // Databases and recordings together, of which it has all.
    let again = json(&["build", shown(&b), shown(&walk), "--out", shown(&both)]);
    assert_eq!((&again["images"], &again["databases"][0]["already_there"]), (&20.into(), &8.into()));
    assert_eq!(again["sequences"][0]["already_there"], 12);

    let report = json(&["split", shown(&both), "--out", shown(&parts)]);
    assert_eq!(report["parts"].as_array().unwrap().len(), 2);
    for (part, original) in report["parts"].as_array().unwrap().iter().zip([&a, &b]) {
        let path = Path::new(part["database"].as_str().unwrap());
        let (part, original) = (Database::open(path).unwrap(), Database::open(original).unwrap());
        assert_eq!(part.images().unwrap().len(), original.images().unwrap().len());
        assert_eq!(
            part.halls().unwrap().into_values().next(),
            original.halls().unwrap().into_values().next()
        );
        let bytes = |database: &Database| database.image_bytes(database.images().unwrap()[3].id).unwrap();
        assert_eq!(bytes(&part), bytes(&original));
    }
    assert!(parts.join("hall-2.db").is_file());
    assert_fails(&["build", shown(&a), "--out", shown(&a)], &["a.db", "is an input"]);
    let missing = own.path().join("missing.db");
    assert_fails(&["split", shown(&missing), "--out", shown(&parts)], &["missing.db", "no such file"]);
    assert_fails(&["split", shown(&parts.join("hall-2.db")), "--out", shown(&parts)], &["holds the input"]);
}

#[test]
fn info_counts_the_images_and_draws_their_coverage() {
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
fn a_recording_that_cannot_be_stored_is_named_and_nothing_stored_is_lost() {
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
fn a_killed_build_resumes_where_it_stopped() {
    const FRAMES: usize = 2000;
    let own = tempfile::tempdir().unwrap();
    let out = own.path().join("out.db");
    // There are enough pictures for several transactions.
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
    // The program is killed once something has been committed.
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
fn impossible_poses_are_refused_before_anything_is_stored() {
    let own = tempfile::tempdir().unwrap();
    let walk = part_of_walk(own.path(), "walk", 0..4);
    let out = own.path().join("out.db");
    for (absurd, words) in [
        ("0 0 -0.5", ["frame 0", "above the ground"]),
        ("1e6 0 0.5", ["frame 0", "above the ground"]),
        ("1e200 0 0.5", ["poses.tum, line 1", "1e200"]),
    ] {
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
        assert_fails(&["build", shown(&walk), "--out", shown(&out), "--poses", shown(&poses)], &words);
    }
    let missing = own.path().join("missing.tum");
    let untouched = own.path().join("untouched.db");
    assert_fails(
        &["build", shown(&walk), "--out", shown(&untouched), "--poses", shown(&missing)],
        &["missing.tum"],
    );
    assert!(!untouched.exists());
}
