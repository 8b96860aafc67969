//! Which package may use which: the library must stay usable without a GPU and without a window.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{collections::BTreeMap, process::Command};

use serde_json::Value;

/// The root package.
const ROOT: &str = "reality-sim";

/// Packages that must build without a graphics card and without a window, directly or not.
const PLAIN: [&str; 5] =
    ["reality-sim-core", "reality-sim-db", "reality-sim-synthesis", "reality-sim-sensor", "reality-sim-gap"];

/// What must not be under them.
const GRAPHICS: [&str; 7] = ["wgpu", "wgpu-core", "winit", "egui", "eframe", "egui-wgpu", "egui-winit"];

/// The packages of this workspace that each package may use.
const MAY_USE: [(&str, &[&str]); 8] = [
    ("reality-sim-core", &[]),
    ("reality-sim-gpu", &["reality-sim-core"]),
    ("reality-sim-db", &["reality-sim-core"]),
    ("reality-sim-synthesis", &["reality-sim-core", "reality-sim-db"]),
    ("reality-sim-sensor", &["reality-sim-core"]),
    ("reality-sim-hidden", &["reality-sim-core"]),
    ("reality-sim-gap", &["reality-sim-core", "reality-sim-sensor"]),
    (
        "reality-sim-viewer",
        &[
            "reality-sim-core",
            "reality-sim-gpu",
            "reality-sim-db",
            "reality-sim-synthesis",
            "reality-sim-sensor",
            "reality-sim-gap",
        ],
    ),
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

/// Every package of the workspace with the names of what it depends on directly, tests excluded.
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

#[test]
fn neither_graphics_card_nor_window_is_under_the_plain_packages() {
    let workspace = workspace();
    for package in PLAIN.iter().filter(|package| workspace.contains_key(**package)) {
        let tree = cargo(&[
            "tree",
            "--package",
            package,
            "--edges",
            "normal,build",
            "--prefix",
            "none",
            "--all-features",
        ]);
        let names: Vec<&str> = tree.lines().filter_map(|line| line.split_whitespace().next()).collect();
        assert!(names.contains(package), "{tree}");
        for forbidden in GRAPHICS {
            assert!(!names.contains(&forbidden), "{forbidden} is under {package}");
        }
    }
}
