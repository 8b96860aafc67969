//! Refusals, each explained in one line.

use std::{fs, process::Command};

use super::{WALK, assert_fails, copy_of_database, demonstration, program, shown, text};

#[test]
fn a_file_that_is_not_a_database_is_named() {
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
fn poses_far_from_every_picture_are_refused() {
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
fn outputs_that_cannot_be_written_or_are_inputs_are_refused() {
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
