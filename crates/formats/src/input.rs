//! Kinds of recordings and models that are read, told by what lies at a path.

use std::path::Path;

use crate::{colmap::is_colmap, log::is_log};

/// Kind of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Folder of a sequence.
    Sequence,
    /// Robot's log: MCAP, SQLite bag, or folder of rosbag2.
    Log,
    /// Folder of a COLMAP model.
    ColmapModel,
    /// nerfstudio's `transforms.json`, or the folder that holds it.
    Nerfstudio,
    /// Mapping file that says which columns of a table are what.
    Table,
}

impl Input {
    /// Tells what lies at a path; `None` if it is nothing that is read.
    pub fn at(path: &Path) -> Option<Self> {
        if path.is_dir() {
            return Self::in_folder(path);
        }
        let name = path.file_name()?.to_str()?;
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("json") if name.starts_with("transforms") => Some(Self::Nerfstudio),
            Some("toml") if name != "sequence.toml" => Some(Self::Table),
            _ => is_log(path).then_some(Self::Log),
        }
    }

    fn in_folder(folder: &Path) -> Option<Self> {
        let holds = |name: &str| folder.join(name).is_file();
        if holds("sequence.toml") {
            Some(Self::Sequence)
        } else if is_log(folder) || holds("metadata.yaml") {
            Some(Self::Log)
        } else if holds("transforms.json") {
            Some(Self::Nerfstudio)
        } else {
            is_colmap(folder).then_some(Self::ColmapModel)
        }
    }
}
