//! What an output is pointed at.

use std::{fs, process::Stdio};

use super::*;

const TAG: [&str; 4] = ["--particles", "100", "--frames", "0..3"];

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_written_into_and_stay() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().unwrap();
    let walk = shown(&short_walk().1);
    let stdout = printed(&[&["tag", walk, "--out", "/dev/stdout"], &TAG[..]].concat());
    assert!(stdout.starts_with("# timestamp x y z"), "{stdout}");
    assert!(fs::symlink_metadata("/dev/stdout").unwrap().is_symlink());
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    printed(&[&["tag", walk, "--out", shown(&pipe)], &TAG[..]].concat());
    assert_eq!(reader.join().unwrap().lines().count(), 4);
    assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
}

/// Other outputs than texts: pictures, databases, folders.
#[cfg(unix)]
#[test]
fn no_command_puts_a_file_in_the_place_of_a_device_or_a_pipe() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().unwrap();
    let (_, walk, database) = short_walk();
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for out in [Path::new("/dev/null"), &pipe] {
        assert_fails(&["build", shown(walk), "--out", shown(out)], &["not a regular file"]);
        assert_fails(&["gap", shown(walk), "--out", shown(out)], &[shown(out)]);
        assert_fails(&["man", "--out", shown(out)], &[shown(out)]);
        let path = ["render", shown(database), "--pose", "-2.3,0.2,1.6", "--out", shown(out)];
        assert_fails(&path, &[shown(out), "png"]);
    }
    assert!(fs::symlink_metadata("/dev/null").unwrap().file_type().is_char_device());
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
}

#[cfg(unix)]
#[test]
fn symbolic_links_stay_and_lead_to_the_output() {
    let folder = tempfile::tempdir().unwrap();
    let (link, far) = (folder.path().join("link.txt"), folder.path().join("far.txt"));
    std::os::unix::fs::symlink("far.txt", &link).unwrap();
    printed(&[&["tag", shown(&short_walk().1), "--out", shown(&link)], &TAG[..]].concat());
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(far).unwrap().lines().count(), 4);
}

#[test]
fn two_names_of_one_file_are_one_output() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = command();
    command.args(["tag", WALK, "--out", "a.txt", "--details", "./a.txt"]).current_dir(folder.path());
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("two outputs"), "{}", text(&output.stderr));
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn nothing_is_created_by_a_run_that_fails() {
    let folder = tempfile::tempdir().unwrap();
    let walk = copy_of_short_walk(folder.path());
    fs::remove_dir_all(walk.join("images")).unwrap();
    for (command, option, word) in [("tag", "--overlay", "pictures"), ("gap", "--out", "frames")] {
        let out = folder.path().join("not/there");
        assert_fails(&[command, shown(&walk), option, shown(&out)], &[word]);
        assert!(!folder.path().join("not").exists(), "{command}");
    }
}

#[test]
fn folders_above_an_output_folder_are_made() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a/b");
    printed(&[&["tag", shown(&short_walk().1), "--overlay", shown(&out)], &TAG[..]].concat());
    assert_eq!(names_in(&out), ["000000.jpg", "000001.jpg", "000002.jpg"]);
}

#[test]
fn a_folder_that_vanishes_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("overlay");
    let mut command = command();
    command.args(["tag", WALK, "--overlay", shown(&out)]).stdout(Stdio::null()).stderr(Stdio::null());
    let mut running = command.spawn().unwrap();
    while names_in_if_there(&out) == 0 && running.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    // A picture may be written into it meanwhile, so that it is not empty in the end.
    while fs::remove_dir_all(&out).is_err() {}
    assert_eq!(running.wait().unwrap().code(), Some(1));
}

fn names_in_if_there(folder: &Path) -> usize {
    fs::read_dir(folder).map_or(0, Iterator::count)
}

/// On a full disk every write fails, as on `/dev/full`; a file that stands in the place of a folder serves for the rest.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_and_leaves_the_old_file() {
    let walk = shown(&short_walk().1);
    assert_fails(
        &[&["tag", walk, "--out", "/dev/full"], &TAG[..]].concat(),
        &["/dev/full", "space on the disk"],
    );
    let mut command = command();
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = command.args(["tag", walk]).args(TAG).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("standard output"), "{}", text(&output.stderr));
}

/// A limit on the size of files is what a process can give itself of a full disk: writing beyond it fails.
#[cfg(unix)]
#[test]
fn where_files_cannot_grow_a_build_fails_and_the_old_database_stays_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (_, _, database) = short_walk();
    let copy = folder.path().join("copy.db");
    fs::copy(database, &copy).unwrap();
    let second = part_of_walk(folder.path(), "second", 20..40);
    let kilobytes = fs::metadata(&copy).unwrap().len() / 1024 + 64;
    // Without `trap`, the signal of the limit would end the program.
    let script = format!(
        "trap '' XFSZ; ulimit -f {kilobytes}; exec {} build {} --out {} --no-hall",
        env!("CARGO_BIN_EXE_reality-sim"),
        shown(&second),
        shown(&copy)
    );
    let output = Command::new("bash").args(["-c", &script]).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr).lines().count(), 1, "{}", text(&output.stderr));
    assert!(printed(&["info", shown(&copy)]).contains("short"));
    printed(&["build", shown(&second), "--out", shown(&copy), "--no-hall"]);
    assert!(printed(&["info", shown(&copy), "--json"]).contains("\"images\": 28"));
}

/// Ctrl-C at any moment leaves whole files and nothing else.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_no_unfinished_file() {
    for milliseconds in [0, 30, 150, 300, 500] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("overlay");
        let mut command = command();
        command.args(["tag", WALK, "--backend", "cpu", "--overlay", shown(&out)]);
        let mut running = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(milliseconds));
        let signal = Command::new("kill").args(["-INT", &running.id().to_string()]).status().unwrap();
        let status = running.wait().unwrap();
        assert!(signal.success());
        let names = if out.exists() { names_in(&out) } else { Vec::new() };
        // A machine may be so fast that the run ended before.
        assert!(!status.success() || names.len() == 60, "{status}, {names:?}");
        assert!(names.iter().all(|name| name.ends_with(".jpg")), "{names:?}");
        for name in names {
            image::open(out.join(name)).unwrap();
        }
    }
}
