//! A build that is killed at any stage is completed by the next one, as if it had never been killed.

use std::{env, sync::Arc};

use reality_sim::pipeline::{Event, Plan, PoseChoice};

use super::*;

/// Variables by which the test tells itself, in a process of its own, what to do and where to die.
const DATABASE: &str = "REALITY_SIM_TEST_DATABASE";
const RECORDING: &str = "REALITY_SIM_TEST_RECORDING";
const STAGE: &str = "REALITY_SIM_TEST_STAGE";

/// Stage at which a build dies.
const STAGES: [&str; 6] = ["poses", "storage", "first picture", "last picture", "ingested", "hall"];

fn is_at(stage: &str, event: &Event) -> bool {
    match event {
        Event::PosesFound { .. } => stage == "poses",
        Event::StorageStarted { .. } => stage == "storage",
        Event::Stored { done, of, .. } => {
            (stage == "first picture" && *done > 0) || (stage == "last picture" && done == of)
        }
        Event::Ingested { .. } => stage == "ingested",
        Event::HallStarted => stage == "hall",
        _ => false,
    }
}

/// Builds in this process, which ends as if it were killed. Does nothing unless the other test asks for it.
#[test]
fn builds_and_dies() {
    let (Ok(database), Ok(recording), Ok(stage)) = (env::var(DATABASE), env::var(RECORDING), env::var(STAGE))
    else {
        return;
    };
    let sequence = Arc::new(Sequence::open(Path::new(&recording)).unwrap());
    let plan = Plan::new([sequence], PoseChoice::ReferenceElseFilter);
    for event in plan.with_database(Path::new(&database)).with_hall(true).start() {
        if is_at(&stage, &event.unwrap()) {
            std::process::abort();
        }
    }
    unreachable!("the build has no stage {stage}");
}

fn build_and_die(recording: &Path, database: &Path, stage: &str) {
    let mut command = Command::new(env::current_exe().unwrap());
    command.args(["--exact", "killed::builds_and_dies", "--nocapture"]);
    command.env(DATABASE, database).env(RECORDING, recording).env(STAGE, stage);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), None, "{stage}: {}", text(&output.stdout));
}

/// Returns what the database says of itself, and a picture made from it.
fn contents(folder: &Path, database: &Path) -> (serde_json::Value, Vec<u8>) {
    let mut info: serde_json::Value =
        serde_json::from_str(&printed(&["info", shown(database), "--json"])).unwrap();
    info.as_object_mut()
        .unwrap()
        .retain(|key, _| !["database", "bytes", "file_bytes"].contains(&key.as_str()));
    let picture = folder.join("picture.png");
    let pose = "-2.3,0.2,1.6";
    let render = ["render", shown(database), "--pose", pose, "--method", "blend", "--best-effort"];
    printed(&[&render[..], &["--out", shown(&picture)]].concat());
    (info, fs::read(picture).unwrap())
}

#[test]
fn a_build_that_was_killed_is_completed_by_the_next() {
    let folder = tempfile::tempdir().unwrap();
    let first = part_of_walk(folder.path(), "first", 0..10);
    let second = part_of_walk(folder.path(), "second", 25..35);
    let [of_first, whole, killed] =
        ["first.db", "whole.db", "killed.db"].map(|name| folder.path().join(name));
    printed(&["build", shown(&first), "--out", shown(&of_first)]);
    fs::copy(&of_first, &whole).unwrap();
    printed(&["build", shown(&second), "--out", shown(&whole)]);
    let expected = contents(folder.path(), &whole);
    for stage in STAGES {
        fs::copy(&of_first, &killed).unwrap();
        build_and_die(&second, &killed, stage);
        printed(&["build", shown(&second), "--out", shown(&killed)]);
        let found = contents(folder.path(), &killed);
        assert_eq!(found.0, expected.0, "killed at {stage}");
        assert!(found.1 == expected.1, "killed at {stage}: another picture");
        for name in names_in(folder.path()).iter().filter(|name| name.starts_with("killed.db")) {
            fs::remove_file(folder.path().join(name)).unwrap();
        }
    }
}

#[test]
fn a_database_that_was_killed_before_its_first_picture_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("new.db");
    build_and_die(&short_walk().1, &database, "poses");
    // The build goes on in its thread until the process has died: it may have stored a picture by then.
    let has_picture = program(&["info", shown(&database)]).status.success();
    if database.exists() && !has_picture {
        assert_fails(&["info", shown(&database)], &["new.db", "holds nothing yet"]);
    }
    printed(&["build", shown(&short_walk().1), "--out", shown(&database)]);
}
