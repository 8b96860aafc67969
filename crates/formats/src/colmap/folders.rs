//! Where a model's files lie.

use std::path::{Path, PathBuf};

/// Folder of the model inside an export, as COLMAP's own projects have it.
pub const MODEL_FOLDER: &str = "sparse/0";

/// Table of the pictures' times, which COLMAP has no place for: columns `image` and `timestamp_s`.
pub const TIMESTAMPS_FILE: &str = "timestamps.csv";

/// Returns the folder that holds the model's files: the given one, or one of those that COLMAP makes in a project.
pub(super) fn model_folder(folder: &Path) -> Option<PathBuf> {
    let candidates = ["", "0", "sparse", MODEL_FOLDER].map(|name| folder.join(name));
    candidates
        .into_iter()
        .find(|folder| ["images.bin", "images.txt"].iter().any(|name| folder.join(name).is_file()))
}

/// Returns whether a path is a folder that holds a COLMAP model, itself or in one of the folders that COLMAP makes.
pub fn is_colmap(path: &Path) -> bool {
    model_folder(path).is_some()
}
