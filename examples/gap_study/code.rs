//! Fingerprint of the code that a study is about: its runs are of one state of the code, or there is no table.

use std::{error::Error, process::Command};

/// Folders whose code decides what is named.
const FOLDERS: [&str; 3] = ["crates/core", "crates/sensor", "crates/gap"];

/// Returns the names under which git knows the folders' content, joined; with a mark if they have been changed since.
pub fn fingerprint() -> Result<String, Box<dyn Error>> {
    let trees = FOLDERS.map(|folder| git(&["rev-parse", "--short=10", &format!("HEAD:{folder}")]));
    let trees = trees.into_iter().collect::<Result<Vec<_>, _>>()?.join("-");
    let status = git(&[&["status", "--porcelain", "--"], &FOLDERS[..]].concat())?;
    Ok(if status.is_empty() { trees } else { format!("{trees}-changed") })
}

/// Whether the code has been changed since the last commit.
pub fn is_changed(fingerprint: &str) -> bool {
    fingerprint.ends_with("-changed")
}

fn git(arguments: &[&str]) -> Result<String, Box<dyn Error>> {
    let output = Command::new("git").args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output()?;
    if !output.status.success() {
        return Err(format!(
            "git {}: {}: run the study in a checkout of the project",
            arguments.join(" "),
            String::from_utf8_lossy(&output.stderr).trim()
        )
        .into());
    }
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}
