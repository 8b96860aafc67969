//! Settings that are kept from one start to the next.

use std::path::{Path, PathBuf};

use eframe::{Storage, egui::ThemePreference};
use serde::de::DeserializeOwned;

use crate::{drive::DriveSettings, gap::GapSettings, walk::WalkSettings};

/// Number of recent paths kept.
const RECENT: usize = 8;

/// All settings of the user. Each part is stored under its own name, so that the others can still be read if another version
/// wrote one differently.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    pub theme: ThemePreference,
    /// Paths of recordings, databases and reports, the most recent first.
    pub recent: Vec<PathBuf>,
    pub walk: WalkSettings,
    pub drive: DriveSettings,
    pub gap: GapSettings,
}

impl Settings {
    /// Loads the stored settings, with defaults for what is missing.
    pub fn load(storage: Option<&dyn Storage>) -> Self {
        Self {
            theme: part(storage, "theme"),
            recent: part(storage, "recent"),
            walk: part(storage, "walk"),
            drive: part(storage, "drive"),
            gap: part(storage, "gap"),
        }
    }

    /// Stores the settings for the next start.
    pub fn store(&self, storage: &mut dyn Storage) {
        eframe::set_value(storage, "theme", &self.theme);
        eframe::set_value(storage, "recent", &self.recent);
        eframe::set_value(storage, "walk", &self.walk);
        eframe::set_value(storage, "drive", &self.drive);
        eframe::set_value(storage, "gap", &self.gap);
    }

    /// Moves a path to the front of the recent ones. A path that is not valid UTF-8 cannot be stored and is ignored.
    pub fn remember(&mut self, path: &Path) {
        if path.to_str().is_none() {
            return;
        }
        self.recent.retain(|recent| recent != path);
        self.recent.insert(0, path.to_path_buf());
        self.recent.truncate(RECENT);
    }
}

fn part<T: DeserializeOwned + Default>(storage: Option<&dyn Storage>, name: &str) -> T {
    storage.and_then(|storage| eframe::get_value(storage, name)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_opened_last_comes_first_and_none_comes_twice() {
        let mut settings = Settings::default();
        for path in ["/a", "/b", "/a"] {
            settings.remember(Path::new(path));
        }
        assert_eq!(settings.recent, [PathBuf::from("/a"), PathBuf::from("/b")]);
    }

    #[test]
    fn the_list_of_recent_paths_has_an_end() {
        let mut settings = Settings::default();
        for number in 0..100 {
            settings.remember(Path::new(&format!("/recording-{number}")));
        }
        assert_eq!(settings.recent.len(), RECENT);
        assert_eq!(settings.recent[0], Path::new("/recording-99"));
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_no_text_is_not_remembered() {
        use std::{ffi::OsStr, os::unix::ffi::OsStrExt};

        let mut settings = Settings::default();
        settings.remember(Path::new(OsStr::from_bytes(b"/walk-\xff")));
        assert!(settings.recent.is_empty());
    }
}
