//! Settings of a comparison, by the names of the program's options.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Settings with which a recording is compared with a model of its camera.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ComparisonSettings {
    /// File with effects that the simulation has already, a model.toml.
    pub model: Option<PathBuf>,
    /// First frame, and the one after the last; `None` for all of them.
    pub frames: Option<[usize; 2]>,
    /// Seed of the filter; modulo 4, it chooses which quarter of the frames is held out.
    pub seed: u64,
    /// File with poses that were estimated from the pictures, as `tag --out` writes them.
    pub poses: Option<PathBuf>,
    /// Whether the filter finds the poses even if the recording has reference poses.
    pub tag: bool,
    /// Names of effects that are left out of the library.
    pub without: Vec<String>,
}
