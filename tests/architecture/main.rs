//! Architecture of the workspace's sources: files of a crate use each other in one direction only, and no file or function
//! is too long to be read at once.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod circles;
mod made_up;
mod module_tree;
mod sizes;

use std::{
    fs,
    path::{Path, PathBuf},
};

use self::module_tree::Sources;

/// Files and functions that may be longer, each with its reason.
const LONG_FOR_A_REASON: [(&str, &str); 0] = [];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the folders of all packages.
fn packages() -> Vec<PathBuf> {
    let crates = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    crates.filter(|folder| folder.join("Cargo.toml").exists()).chain([root().to_owned()]).collect()
}

/// Reads the Rust files below a folder, by their path relative to the workspace's root.
fn sources(folder: &Path) -> Sources {
    let mut sources = Sources::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() && !path.is_symlink() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let parts = path.strip_prefix(root()).unwrap().iter().map(|part| part.to_str().unwrap());
                sources.insert(parts.collect::<Vec<_>>().join("/"), fs::read_to_string(&path).unwrap());
            }
        }
    }
    sources
}

/// Describes the circles between the files of every crate, and between the modules that its root declares.
fn all_circles() -> Vec<String> {
    let mut found = Vec::new();
    for package in packages() {
        let sources = sources(&package.join("src"));
        for root in
            sources.keys().filter(|file| file.ends_with("src/lib.rs") || file.ends_with("src/main.rs"))
        {
            let files = circles::uses(&sources, root);
            let modules = circles::between_top_modules(&files, root);
            for uses in [&files, &modules] {
                let circles = circles::circles(uses).into_iter();
                found.extend(circles.map(|circle| circles::describe(&circle, uses)));
            }
        }
    }
    found
}

#[test]
fn no_files_or_modules_of_a_crate_use_each_other_in_a_circle() {
    let found = all_circles();
    assert!(found.is_empty(), "circles:\n{}", found.join("\n\n"));
}

#[test]
fn every_crate_is_read_and_its_files_use_each_other() {
    let packages = packages();
    assert!(packages.len() >= 9, "only {} packages were found", packages.len());
    for package in packages {
        let sources = sources(&package.join("src"));
        let root = sources.keys().find(|file| file.ends_with("src/lib.rs") || file.ends_with("src/main.rs"));
        let root = root.unwrap_or_else(|| panic!("{} has no root", package.display()));
        assert!(!circles::uses(&sources, root).is_empty(), "{root}: no file uses another");
    }
}

#[test]
fn no_file_or_function_exceeds_its_limit() {
    let folders = packages()
        .into_iter()
        .flat_map(|package| ["src", "tests", "examples", "benches"].map(|folder| package.join(folder)));
    let sources = folders.flat_map(|folder| sources(&folder));
    let found: Vec<(String, usize)> =
        sources.flat_map(|(file, text)| sizes::too_long(&file, &text)).collect();
    let is_excused = |place: &str| LONG_FOR_A_REASON.iter().any(|(excused, _)| place == *excused);
    let places: Vec<String> = found
        .iter()
        .filter(|(place, _)| !is_excused(place))
        .map(|(place, lines)| format!("  {place}: {lines} lines"))
        .collect();
    assert!(places.is_empty(), "too long:\n{}", places.join("\n"));
    for (place, _) in LONG_FOR_A_REASON {
        assert!(found.iter().any(|(long, _)| long == place), "{place} is short by now: it needs no excuse");
    }
}
