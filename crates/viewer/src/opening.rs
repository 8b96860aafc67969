//! Opening of paths: a path leads to a recording, a database, or a report of the gap.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use reality_sim_core::sequence::Sequence;
use reality_sim_synthesis::Archive;

use crate::gap::Loaded;

/// Memory for decoded pictures of a database, bytes.
pub const CACHE_BYTES: usize = 512 << 20;

/// Opened path.
pub enum Opened {
    Recording(Arc<Sequence>),
    Database(Arc<Archive>),
    Report(Box<Loaded>),
}

impl Opened {
    /// Returns its kind in words.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Recording(_) => "a recording",
            Self::Database(_) => "a database",
            Self::Report(_) => "a report",
        }
    }
}

/// Opens a folder as a recording or a report, a file as a database. The error names the fault and the remedy.
pub fn open(path: &Path) -> Result<Opened, String> {
    if is_report(path) {
        Ok(Opened::Report(Box::new(Loaded::read(path)?)))
    } else if path.is_file() {
        let archive = Archive::open(path, CACHE_BYTES).map_err(|error| error.to_string())?;
        Ok(Opened::Database(Arc::new(archive)))
    } else {
        let sequence = Sequence::open(path).map_err(|error| error.to_string())?;
        Ok(Opened::Recording(Arc::new(sequence)))
    }
}

/// Whether a folder was written by `reality-sim gap`, complete or not. A recording with reports in its folder remains a
/// recording.
fn is_report(folder: &Path) -> bool {
    let has = |name: &str| folder.join(name).exists();
    !has("sequence.toml") && ["report.json", "report.html", "pictures/measured.png"].into_iter().any(has)
}

/// Returns the canonical path, so that each recording, database or report has one name: absolute, with recordings and
/// reports named by their folder.
pub fn whole(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    match path.parent() {
        Some(folder)
            if path.file_name().is_some_and(|name| name == "sequence.toml" || name == "report.json") =>
        {
            folder.to_path_buf()
        }
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_has_one_name_however_it_is_written() {
        let here = std::env::current_dir().unwrap();
        for path in ["walk", "./walk", "walk/", "walk/sequence.toml"] {
            assert_eq!(whole(Path::new(path)), here.join("walk"), "{path}");
        }
        assert_eq!(whole(Path::new("sequence.toml")), here);
        assert_eq!(whole(Path::new("found/report.json")), here.join("found"));
    }

    #[test]
    fn a_folder_is_a_report_by_what_is_in_it_but_a_recording_stays_one() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!is_report(folder.path()));
        std::fs::write(folder.path().join("report.html"), "").unwrap();
        assert!(is_report(folder.path()), "that report.json is missing is said when it is read");
        std::fs::write(folder.path().join("sequence.toml"), "").unwrap();
        assert!(!is_report(folder.path()));
    }
}
