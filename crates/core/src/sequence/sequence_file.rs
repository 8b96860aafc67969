//! `sequence.toml`: name of the recording, its files and its start pose.

use std::path::{Component, Path};

use serde::{Deserialize, Serialize};

use super::{
    error::{Fault, SequenceError, excerpt},
    printable::is_printable,
    toml_text::{NumberCheck, line_of_key, parse},
};
use crate::pose::Pose2;

/// Name of the file that makes a folder a sequence.
pub(super) const SEQUENCE_FILE: &str = "sequence.toml";

/// Table as the file holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SequenceTable {
    pub name: String,
    pub camera: String,
    pub field: String,
    pub frames: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub groundtruth: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<StartTable>,
}

/// Table for a [`Pose2`] to which other programs may add keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct StartTable {
    x_m: f64,
    y_m: f64,
    yaw_rad: f64,
}

impl From<Pose2> for StartTable {
    fn from(pose: Pose2) -> Self {
        Self { x_m: pose.x_m, y_m: pose.y_m, yaw_rad: pose.yaw_rad }
    }
}

impl From<StartTable> for Pose2 {
    fn from(start: StartTable) -> Self {
        Self::new(start.x_m, start.y_m, start.yaw_rad)
    }
}

/// Parses the table from the text of its file. An empty name of the ground truth's file means that there is none.
pub(super) fn parse_sequence(path: &Path, text: &str) -> Result<SequenceTable, SequenceError> {
    let mut table: SequenceTable = parse(path, text)?;
    table.groundtruth = table.groundtruth.filter(|name| !name.is_empty());
    if !is_printable(&table.name) {
        let fault = Fault::BadName { key: "name", name: excerpt(&table.name) };
        return Err(SequenceError::at(path, line_of_key(text, &["name"]), fault));
    }
    let files = [
        ("camera", Some(&table.camera)),
        ("field", Some(&table.field)),
        ("frames", Some(&table.frames)),
        ("groundtruth", table.groundtruth.as_ref()),
    ];
    for (key, name) in files {
        if let Some(name) = name.filter(|name| !is_inside_folder(Path::new(name))) {
            let fault = Fault::PathLeavesFolder { name: excerpt(name) };
            return Err(SequenceError::at(path, line_of_key(text, &[key]), fault));
        }
    }
    if let Some(start) = table.start {
        let numbers = NumberCheck { path, text, table: "start" };
        for (key, value) in [("x_m", start.x_m), ("y_m", start.y_m), ("yaw_rad", start.yaw_rad)] {
            numbers.check(key, value, |_| true, "a finite number")?;
        }
    }
    Ok(table)
}

/// Returns whether a relative path names something inside the folder to which it is relative.
pub fn is_inside_folder(path: &Path) -> bool {
    let mut names = 0;
    for component in path.components() {
        match component {
            Component::Normal(_) => names += 1,
            Component::CurDir => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return false,
        }
    }
    names > 0
}
