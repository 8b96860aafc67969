//! What is remembered from one start to the next.

use std::path::{Path, PathBuf};

use eframe::{Storage, egui::ThemePreference};
use serde::{Deserialize, Serialize};

use crate::{drive::DriveSettings, walk::WalkSettings};

const KEY: &str = "settings";
/// Files remembered.
const RECENT: usize = 8;

/// Everything that a person sets.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    pub theme: ThemePreference,
    /// Recordings and databases, the last opened first.
    pub recent: Vec<PathBuf>,
    pub walk: WalkSettings,
    pub drive: DriveSettings,
}

impl Settings {
    /// Those of the last time, or the defaults where there was none, or another version.
    pub fn load(storage: Option<&dyn Storage>) -> Self {
        storage.and_then(|storage| eframe::get_value(storage, KEY)).unwrap_or_default()
    }

    /// For the next time.
    pub fn store(&self, storage: &mut dyn Storage) {
        eframe::set_value(storage, KEY, self);
    }

    /// Puts a path to the front of the recent ones.
    pub fn remember(&mut self, path: &Path) {
        self.recent.retain(|recent| recent != path);
        self.recent.insert(0, path.to_path_buf());
        self.recent.truncate(RECENT);
    }
}
