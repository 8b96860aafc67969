//! The library as a dependency of others: `tests/minimal_user` is a package outside the workspace.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Dependencies that nobody should get who only wants the library.
const FORBIDDEN: [&str; 7] = ["clap", "indicatif", "anyhow", "wgpu", "winit", "egui", "eframe"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the package's folder, with the versions of the workspace's `Cargo.lock`, which are available without a network.
fn user() -> PathBuf {
    let folder = root().join("tests/minimal_user");
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    folder
}

/// Writes how the workspace is compiled as settings of cargo: what both need is compiled once. Our own packages, which have fewer
/// features here and are compiled again, are not optimised: that takes longer than the one picture.
fn profile(folder: &Path) -> PathBuf {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let start = manifest.find("[profile.dev]").unwrap();
    let end = manifest.find("[profile.release]").unwrap();
    let file = folder.join("profile.toml");
    let sections = manifest[start..end].split("\n\n").map(|section| {
        let is_own = section.starts_with("[profile.dev.package.reality-sim");
        if is_own { section.replace("opt-level = 3", "opt-level = 0") } else { section.to_owned() }
    });
    fs::write(&file, sections.collect::<Vec<_>>().join("\n\n")).unwrap();
    file
}

/// Runs a cargo command and returns its standard output. It compiles into the workspace's target folder, which already
/// contains most of what is needed.
fn cargo(folder: &Path, profile: &Path, arguments: &[&str]) -> String {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let output = Command::new(env!("CARGO"))
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", target)
        .args(&arguments[..1])
        .arg("--offline")
        .arg("--config")
        .arg(profile)
        .args(&arguments[1..])
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_package_outside_the_workspace_gets_a_picture_without_graphics_or_a_programs_crates() {
    let folder = user();
    let own = tempfile::tempdir().unwrap();
    let profile = profile(own.path());
    let tree = cargo(&folder, &profile, &["tree", "--edges", "normal,build", "--prefix", "none"]);
    // Each line has name and version; packages printed before are marked after that.
    let packages: BTreeSet<Vec<&str>> =
        tree.lines().map(|line| line.split_whitespace().take(2).collect()).collect();
    println!("the library pulls in {} packages, itself among them", packages.len() - 1);
    let names: BTreeSet<&str> = packages.iter().filter_map(|package| package.first().copied()).collect();
    assert!(names.contains("reality-sim") && names.contains("glam"), "{tree}");
    for forbidden in FORBIDDEN {
        assert!(!names.contains(forbidden), "{forbidden} is under the library");
    }

    let (walk, database) = (root().join("assets/walk"), own.path().join("walk.db"));
    let arguments = ["run", "--quiet", "--", walk.to_str().unwrap(), database.to_str().unwrap()];
    let said = cargo(&folder, &profile, &arguments);
    let recorded: f64 = said.split_whitespace().rev().nth(1).unwrap().parse().unwrap();
    assert!(said.starts_with("160 x 120 ") && recorded > 0.9, "{said}");
}
