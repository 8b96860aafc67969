//! Input that asks for more memory than it is worth.

use std::fs;

use super::*;

/// Limit on a run's address space, kilobytes: twenty times what it takes on the walk's own pictures, and half of what the
/// input asks for.
const LIMIT_KB: u64 = 6 << 20;

/// Runs the program under a limit on its address space, with one thread, since every thread reserves some of it.
#[cfg(target_os = "linux")]
fn refused_within_limit(arguments: &[&str], words: &[&str]) {
    let quoted: Vec<String> = arguments.iter().map(|argument| format!("'{argument}'")).collect();
    let script =
        format!("ulimit -v {LIMIT_KB}; exec {} {}", env!("CARGO_BIN_EXE_reality-sim"), quoted.join(" "));
    let mut command = Command::new("bash");
    let output = command.args(["-c", &script]).env("RAYON_NUM_THREADS", "1").output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for word in words {
        assert!(message.contains(word), "{message} does not say {word}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_huge_camera_is_refused_before_anything_is_allocated() {
    let folder = tempfile::tempdir().unwrap();
    let camera = folder.path().join("huge.toml");
    let own = fs::read_to_string(Path::new(WALK).join("camera.toml")).unwrap();
    let sized = |width: u32, height: u32| {
        let lines = own.lines().map(|line| match line.split(' ').next() {
            Some("width") => format!("width = {width}\n"),
            Some("height") => format!("height = {height}\n"),
            _ => format!("{line}\n"),
        });
        fs::write(&camera, lines.collect::<String>()).unwrap();
    };
    let out = folder.path().join("out.png");
    let render = ["render", shown(&short_walk().2), "--pose", "0,0,0", "--out", shown(&out), "--camera"];
    sized(32768, 32768);
    refused_within_limit(&[&render[..], &[shown(&camera)]].concat(), &["huge.toml, line", "32768"]);
    // The largest that is accepted is refused for its pictures before the filter is set up for it.
    sized(8192, 4096);
    refused_within_limit(&["tag", WALK, "--camera", shown(&camera)], &["640 x 480", "8192 x 4096"]);
}

#[test]
fn a_long_text_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let walk = copy_of_short_walk(folder.path());
    for name in ["sequence.toml", "camera.toml", "field.toml"] {
        let own = fs::read_to_string(walk.join(name)).unwrap();
        fs::write(walk.join(name), format!("{own}\n# {}", "x".repeat(2 << 20))).unwrap();
        assert_fails(&["tag", shown(&walk)], &[name, "larger than"]);
        fs::write(walk.join(name), own).unwrap();
    }
}
