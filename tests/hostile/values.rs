//! Numbers that are finite and mean nothing.

use super::*;

/// Asserts that `tag` refuses the walk after a change of one of its files.
fn assert_refused(file: &str, from: &str, to: &str, words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let walk = copy_of_short_walk(folder.path());
    edit(&walk.join(file), |text| text.replacen(from, to, 1));
    assert_fails(&["tag", shown(&walk), "--particles", "50"], words);
}

#[test]
fn impossible_odometry_angles_and_times_are_refused() {
    let walk = Sequence::open(&short_walk().1).unwrap();
    let frame = &walk.frames[3];
    let odometry = frame.odometry.unwrap();
    for (value, column) in [
        (odometry.x_m, "odometry_x_m"),
        (odometry.yaw_rad, "odometry_yaw_rad"),
        (frame.pitch_rad, "pitch_rad"),
        (frame.timestamp_s, "timestamp_s"),
    ] {
        let words = ["frames.csv, line 5", column];
        assert_refused("frames.csv", &format!("{value},"), "-1e308,", &words);
    }
}

#[test]
fn impossible_cameras_are_refused() {
    let gamma = |text: &str| text.lines().find(|line| line.starts_with("gamma")).unwrap().to_owned();
    let camera = fs::read_to_string(short_walk().1.join("camera.toml")).unwrap();
    assert_refused("camera.toml", &gamma(&camera), "gamma = 1e5", &["camera.toml, line", "gamma"]);
}

#[test]
fn places_beyond_every_field_are_refused() {
    let output = program(&["tag", WALK, "--start", "1e300,0,0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("200 m"), "{}", text(&output.stderr));
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("far.png");
    let far = ["render", shown(&short_walk().2), "--pose", "1e300,0,0", "--out", shown(&out)];
    for method in ["auto", "simulated"] {
        assert_fails(&[&far[..], &["--method", method]].concat(), &["200 m"]);
        assert!(!out.exists());
    }
}

#[test]
fn missing_pictures_are_counted_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let walk = copy_of_short_walk(folder.path());
    let sequence = Sequence::open(&walk).unwrap();
    for frame in [5, 7] {
        fs::remove_file(sequence.image_path(frame).unwrap()).unwrap();
    }
    let words = ["2 of its 8 pictures are missing", shown(&sequence.frames[5].image)];
    let out = folder.path().join("out");
    assert_fails(&["tag", shown(&walk), "--out", shown(&out)], &words);
    assert_fails(&["build", shown(&walk), "--out", shown(&out)], &words);
    assert_fails(&["evaluate", shown(&short_walk().2), shown(&walk), "--details", shown(&out)], &words);
    assert!(!out.exists());
}

#[test]
fn what_was_done_before_a_broken_picture_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let walk = copy_of_short_walk(folder.path());
    let sequence = Sequence::open(&walk).unwrap();
    let broken = sequence.image_path(6).unwrap();
    let bytes = fs::read(&broken).unwrap();
    fs::write(&broken, &bytes[..bytes.len() / 2]).unwrap();
    let (out, details) = (folder.path().join("poses.txt"), folder.path().join("details.csv"));
    let words = ["holds the first 6 of 8 frames", shown(&sequence.frames[6].image)];
    for smooth in [&[] as &[&str], &["--smooth"]] {
        assert_fails(&[&["tag", shown(&walk), "--out", shown(&out)], smooth].concat(), &words);
        assert_eq!(fs::read_to_string(&out).unwrap().lines().count(), 1 + 6);
    }
    let evaluate = ["evaluate", shown(&short_walk().2), shown(&walk), "--details", shown(&details)];
    assert_fails(&evaluate, &["holds 6 of 8 probes", shown(&sequence.frames[6].image)]);
}

/// Spoils pictures of a sequence: one is cut off, of the other the last three quarters are zeros.
fn spoiled(sequence: &Sequence) {
    for (frame, is_cut) in [(2, true), (5, false)] {
        let file = sequence.image_path(frame).unwrap();
        let mut bytes = fs::read(&file).unwrap();
        let quarter = bytes.len() / 4;
        if is_cut {
            bytes.truncate(quarter);
        } else {
            let end = bytes.len() - 2;
            bytes[quarter..end].fill(0);
        }
        fs::write(file, bytes).unwrap();
    }
}

#[test]
fn damaged_pictures_are_counted_and_named_and_the_others_are_stored() {
    let folder = tempfile::tempdir().unwrap();
    let walk = copy_of_short_walk(folder.path());
    let sequence = Sequence::open(&walk).unwrap();
    let originals: Vec<Vec<u8>> =
        (0..8).map(|frame| fs::read(sequence.image_path(frame).unwrap()).unwrap()).collect();
    spoiled(&sequence);
    let database = folder.path().join("walk.db");
    let [second, fifth] = [2, 5].map(|frame| shown(&sequence.frames[frame].image));
    let words = ["2 of its 8 pictures cannot be used", second, fifth, "cut off"];
    assert_fails(&["tag", shown(&walk)], &words);
    assert_fails(&["evaluate", shown(&short_walk().2), shown(&walk)], &words);
    let build = ["build", shown(&walk), "--out", shown(&database)];
    assert_fails(&[&build[..], &["--tag"]].concat(), &words);
    assert_fails(&build, &[&words[..], &["walk.db", "the recording's other 6 pictures"]].concat());
    assert!(printed(&["info", shown(&database)]).contains("6 pictures"));
    for (frame, bytes) in originals.iter().enumerate() {
        fs::write(sequence.image_path(frame).unwrap(), bytes).unwrap();
    }
    assert!(printed(&build).contains("2 pictures added, 6 already there"));
}

#[test]
fn one_is_not_called_many() {
    let folder = tempfile::tempdir().unwrap();
    let walk = part_of_walk(folder.path(), "one", 0..1);
    let database = folder.path().join("one.db");
    for words in [
        printed(&["tag", shown(&walk), "--particles", "50"]),
        printed(&["build", shown(&walk), "--out", shown(&database), "--no-hall"]),
        printed(&["info", shown(&database)]),
        printed(&["remove", shown(&database), "--sequence", "one"]),
    ] {
        let is_plural =
            |pair: &[&str]| pair[0] == "1" && pair[1].trim_end_matches([',', ';', '.']).ends_with('s');
        let all: Vec<&str> = words.split_whitespace().collect();
        assert!(!all.windows(2).any(is_plural), "{words}");
    }
}

#[test]
fn negative_values_are_values() {
    for (arguments, word) in [
        (["tag", WALK, "--particles", "-1"], "-1 is not in"),
        (["tag", WALK, "--blur", "-1"], "from 0 to 50"),
        (["tag", WALK, "--seed", "-1"], "-1"),
    ] {
        let output = program(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = text(&output.stderr);
        assert!(message.contains(word) && !message.contains("'-- "), "{message}");
    }
}

#[test]
fn a_late_usage_error_shows_the_usage_of_its_command() {
    let output = program(&["tag", WALK, "--alpha", "10"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("Usage: reality-sim tag"), "{}", text(&output.stderr));
}

#[test]
fn a_quiet_program_writes_its_files_and_prints_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("poses.txt");
    let arguments = ["tag", shown(&short_walk().1), "--particles", "50", "--out", shown(&out)];
    assert_eq!(printed(&[&["--quiet"], &arguments[..]].concat()), "");
    assert!(out.exists());
    assert!(!printed(&[&arguments[..], &["-q", "--json"]].concat()).is_empty());
}

#[test]
fn shells_and_man_know_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    printed(&["man", "--out", shown(&pages)]);
    let help = printed(&["help"]);
    let script = printed(&["completions", "bash"]);
    for command in ["tag", "build", "render", "evaluate", "info", "remove", "gap"] {
        assert!(help.contains(&format!("\n  {command} ")), "{help}");
        assert!(
            script.contains(&format!("reality__sim__{command}")) || script.contains(command),
            "{command}"
        );
        let page = fs::read_to_string(pages.join(format!("reality-sim-{command}.1"))).unwrap();
        assert!(page.contains(".SH OPTIONS") && page.contains("reality\\-sim\\-"), "{command}");
    }
    assert!(pages.join("reality-sim.1").exists());
}
