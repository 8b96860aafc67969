//! What a path leads to: a recording, or a database.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use reality_sim_core::sequence::Sequence;
use reality_sim_synthesis::Archive;

/// Bytes spent on decoded pictures of a database.
pub const CACHE_BYTES: usize = 512 << 20;

/// Something that was opened.
pub enum Opened {
    Recording(Arc<Sequence>),
    Database(Arc<Archive>),
}

/// Opens a folder as a recording, a file as a database. The error says what is wrong, and what to do.
pub fn open(path: &Path) -> Result<Opened, String> {
    if path.is_file() {
        let archive = Archive::open(path, CACHE_BYTES).map_err(|error| error.to_string())?;
        Ok(Opened::Database(Arc::new(archive)))
    } else {
        let sequence = Sequence::open(path).map_err(|error| error.to_string())?;
        Ok(Opened::Recording(Arc::new(sequence)))
    }
}

/// One name for one thing: from the root on, a recording by its folder.
pub fn whole(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    match path.parent() {
        Some(folder) if path.file_name().is_some_and(|name| name == "sequence.toml") => folder.to_path_buf(),
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
    }
}
