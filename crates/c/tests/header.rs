//! The header is that of the source, and a program in C works with it.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
    sync::Arc,
};

use reality_sim::{
    Archive, Pose2, Sequence,
    db::{Database, PoseEstimate, PoseSource},
};

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_header_is_that_of_the_source() {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).unwrap();
    let builder = cbindgen::Builder::new().with_src(folder().join("src/lib.rs"));
    let mut made = Vec::new();
    builder.with_config(config).generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    assert_eq!(made.matches(" rs_camera_open(const").count(), 1, "functions are declared once");
    let file = folder().join("include/reality_sim.h");
    if env::var_os("HEADER").is_some_and(|wish| wish == "write") {
        fs::write(&file, &made).unwrap();
    }
    let found = fs::read_to_string(&file).unwrap_or_default();
    assert!(
        found == made,
        "include/reality_sim.h is not that of the source: HEADER=write cargo test --package reality-sim-c"
    );
}

/// Returns the folder in which cargo puts the libraries: two above that of the tests.
fn libraries() -> PathBuf {
    env::current_exe().unwrap().parent().unwrap().to_path_buf()
}

/// Returns the C compiler.
fn compiler() -> Command {
    Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()))
}

fn compiled(into: &Path) -> PathBuf {
    let program = into.join("camera");
    let libraries = libraries();
    let output = compiler()
        .args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1"])
        .arg(folder().join("examples/camera.c"))
        .arg("-I")
        .arg(folder().join("include"))
        .arg("-L")
        .arg(&libraries)
        .args(["-lreality_sim_c", "-lm"])
        .arg(format!("-Wl,-rpath,{}", libraries.display()))
        .arg("-o")
        .arg(&program)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    program
}

#[test]
fn the_example_sees_what_the_library_sees() {
    let folder = tempfile::tempdir().unwrap();
    let [database, picture] = ["walk.db", "picture.ppm"].map(|name| folder.path().join(name));
    let walk = Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk")).unwrap();
    let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    Database::create_or_open(&database).unwrap().ingest(&walk, &poses, &PoseSource::GroundTruth).unwrap();
    let program = compiled(folder.path());

    let output = Command::new(&program).args([&database, &picture]).output().unwrap();
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{told}{}", String::from_utf8_lossy(&output.stderr));
    for part in ["ball: columns", "robot: columns", "centre of the ball:", "no pose: pose: holds a number"] {
        assert!(told.contains(part), "{told}");
    }

    // The same through the library.
    let archive = Arc::new(Archive::open(&database, 256 << 20).unwrap());
    let pose = archive.usual_pose().with_planar(Pose2::new(-2.3, 0.2, 1.6));
    let mut camera = reality_sim::simulator::Camera::new(archive);
    let mut frame = reality_sim::simulator::Frame::default();
    let color = |srgb: [u8; 3]| srgb.map(reality_sim::sensor::linear_from_srgb).into();
    let ball = reality_sim::simulator::Ball::on_ground(-2.5, 1.1, 0.065, color([255, 128, 0]));
    let robot =
        reality_sim::simulator::Humanoid::standing(Pose2::new(-2.0, 1.7, -1.6), 0.58, color([40, 90, 220]));
    camera.look(pose, &[&ball, &robot], &mut frame).unwrap();
    let written = fs::read(&picture).unwrap();
    let pixels = written.strip_prefix(b"P6\n640 480\n255\n").unwrap();
    assert!(pixels == frame.picture.as_raw().as_slice(), "the pictures differ");
    let seen = frame.objects[0].visible.unwrap();
    let place = format!("columns {} to {}, rows {} to {}", seen.left, seen.right, seen.top, seen.bottom);
    assert!(told.contains(&place), "{told} {place}");

    let missing = Command::new(&program).args([&folder.path().join("none.db"), &picture]).output().unwrap();
    let words = String::from_utf8(missing.stderr).unwrap();
    assert!(!missing.status.success() && words.contains("none.db"), "{words}");
}
