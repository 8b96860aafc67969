//! Rules on which package may use which: the library must stay usable without a GPU, without a window and without the
//! dependencies of a program. Also checks the contents of the packages.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{collections::BTreeMap, path::Path, process::Command};

use serde_json::Value;

/// The root package, the program.
const ROOT: &str = "reality-sim-cli";

/// Package of the library. Graphics may come only with its feature `gpu`.
const LIBRARY: &str = "reality-sim";

/// The one part of the library that uses graphics.
const GPU: &str = "reality-sim-gpu";

/// Dependencies that belong to a graphics card or a window.
const GRAPHICS: [&str; 7] = ["wgpu", "wgpu-core", "winit", "egui", "eframe", "egui-wgpu", "egui-winit"];

/// Dependencies that belong to a program.
const PROGRAM: [&str; 3] = ["clap", "indicatif", "anyhow"];

/// All parts of the library.
const PARTS: &[&str] = &[
    "reality-sim-core",
    GPU,
    "reality-sim-db",
    "reality-sim-synthesis",
    "reality-sim-pipeline",
    "reality-sim-sensor",
    "reality-sim-gap",
    "reality-sim-formats",
    "reality-sim-calibration",
    "reality-sim-simulator",
];

/// Packages of this workspace that each package may use.
const MAY_USE: [(&str, &[&str]); 15] = [
    ("reality-sim-core", &[]),
    (GPU, &["reality-sim-core"]),
    ("reality-sim-db", &["reality-sim-core"]),
    ("reality-sim-synthesis", &["reality-sim-core", "reality-sim-db", "reality-sim-sensor"]),
    (
        "reality-sim-pipeline",
        &["reality-sim-calibration", "reality-sim-core", "reality-sim-db", "reality-sim-synthesis"],
    ),
    ("reality-sim-sensor", &["reality-sim-core"]),
    ("reality-sim-hidden", &["reality-sim-core"]),
    ("reality-sim-gap", &["reality-sim-core", "reality-sim-sensor"]),
    ("reality-sim-formats", &["reality-sim-core"]),
    ("reality-sim-calibration", &["reality-sim-core"]),
    (
        "reality-sim-simulator",
        &["reality-sim-core", "reality-sim-db", "reality-sim-sensor", "reality-sim-synthesis"],
    ),
    (LIBRARY, PARTS),
    ("reality-sim-viewer", PARTS),
    ("reality-sim-python", &[LIBRARY]),
    ("reality-sim-c", &[LIBRARY]),
];

fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .args(["--offline", "--locked"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Returns every package of the workspace with the names of its direct dependencies, tests excluded.
fn workspace() -> BTreeMap<String, Vec<String>> {
    let metadata: Value =
        serde_json::from_str(&cargo(&["metadata", "--no-deps", "--format-version", "1"])).unwrap();
    let name = |value: &Value| value["name"].as_str().unwrap().to_owned();
    let packages = metadata["packages"].as_array().unwrap().iter();
    packages
        .map(|package| {
            let dependencies = package["dependencies"].as_array().unwrap().iter();
            (name(package), dependencies.filter(|dependency| dependency["kind"] != "dev").map(name).collect())
        })
        .collect()
}

#[test]
fn packages_use_each_other_in_one_direction() {
    let workspace = workspace();
    assert!(workspace.contains_key(ROOT) && workspace.contains_key("reality-sim-core"));
    for (package, dependencies) in workspace.iter().filter(|(package, _)| *package != ROOT) {
        let rule = MAY_USE.iter().find(|(name, _)| name == package);
        let (_, allowed) = rule.unwrap_or_else(|| panic!("{package} has no rule: give it one in MAY_USE"));
        for used in dependencies.iter().filter(|used| workspace.contains_key(*used)) {
            assert!(allowed.contains(&used.as_str()), "{package} must not use {used}");
        }
    }
}

/// Returns the names of a package and of everything that it is built from, tests excluded, and what only macros use: they run
/// in the compiler.
fn packages_under(package: &str, features: &[&str]) -> Vec<String> {
    let arguments =
        ["tree", "--package", package, "--edges", "normal,build,no-proc-macro", "--prefix", "none"];
    let tree = cargo(&[&arguments, features].concat());
    let names: Vec<String> =
        tree.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    assert!(names.iter().any(|name| name == package), "{tree}");
    names
}

#[test]
fn the_library_depends_on_neither_graphics_nor_a_programs_crates() {
    let workspace = workspace();
    let plain = PARTS.iter().filter(|package| **package != GPU).map(|package| (*package, "--all-features"));
    for (package, features) in plain.chain([(LIBRARY, "--features=")]) {
        assert!(workspace.contains_key(package), "{package} is not in the workspace");
        let names = packages_under(package, &[features]);
        for forbidden in GRAPHICS.iter().chain(&PROGRAM) {
            assert!(!names.iter().any(|name| name == forbidden), "{forbidden} is under {package}");
        }
    }
}

#[test]
fn the_feature_gpu_adds_wgpu_to_the_library_but_no_window() {
    let names = packages_under(LIBRARY, &["--features=gpu"]);
    assert!(names.iter().any(|name| name == "wgpu"));
    for forbidden in ["winit", "egui"].iter().chain(&PROGRAM) {
        assert!(!names.iter().any(|name| name == forbidden), "{forbidden} is under {LIBRARY}");
    }
}

/// The shaders are outside the package that is built from them, which reaches them through a link.
#[test]
fn every_shader_is_in_the_package_that_is_built_from_it() {
    let list = cargo(&["package", "--list", "--allow-dirty", "--package", GPU]);
    let packed = |name: &str| list.lines().any(|line| Path::new(line) == Path::new("shaders").join(name));
    let shaders = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders")).unwrap();
    let mut count = 0;
    for entry in shaders.map(Result::unwrap).filter(|entry| entry.file_type().unwrap().is_file()) {
        let name = entry.file_name().into_string().unwrap();
        assert!(packed(&name), "{name} is not in the package");
        count += 1;
    }
    assert!(count > 10 && packed("shared/camera.wgsl"), "{list}");
}
