//! Files that belong to a log.

use std::{
    ffi::OsStr,
    fs,
    path::{Component, Path, PathBuf},
};

use tempfile::NamedTempFile;

use super::{
    compressed::unpack,
    error::{LogError, LogFault},
};

/// Largest `metadata.yaml` that is read, bytes.
const MAX_METADATA_BYTES: u64 = 1 << 20;

/// File of a log.
#[derive(Debug)]
pub(super) enum LogFile {
    Mcap(PathBuf),
    Sqlite(PathBuf),
    /// Compressed as a whole by zstd.
    Packed(PathBuf, Box<LogFile>),
}

impl LogFile {
    /// Tells the kind of a file by its name.
    fn by_name(path: &Path) -> Option<Self> {
        match path.extension().and_then(OsStr::to_str)? {
            "mcap" => Some(Self::Mcap(path.to_path_buf())),
            "db3" => Some(Self::Sqlite(path.to_path_buf())),
            "zstd" | "zst" => Self::by_name(&path.with_extension(""))
                .map(|inner| Self::Packed(path.to_path_buf(), Box::new(inner))),
            _ => None,
        }
    }

    pub fn path(&self) -> &Path {
        match self {
            Self::Mcap(path) | Self::Sqlite(path) | Self::Packed(path, _) => path,
        }
    }

    /// Returns the file as it can be read: itself, or an unpacked copy, which is removed when it is dropped.
    pub fn unpacked(&self) -> Result<Unpacked<'_>, LogError> {
        let Self::Packed(path, inner) = self else { return Ok(Unpacked::Itself(self)) };
        let copy = unpack(path)?;
        let path = copy.path().to_path_buf();
        let file = match **inner {
            Self::Sqlite(_) => Self::Sqlite(path),
            _ => Self::Mcap(path),
        };
        Ok(Unpacked::Copy { file, _copy: copy })
    }
}

/// File that can be read.
pub(super) enum Unpacked<'a> {
    Itself(&'a LogFile),
    Copy { file: LogFile, _copy: NamedTempFile },
}

impl std::ops::Deref for Unpacked<'_> {
    type Target = LogFile;

    fn deref(&self) -> &LogFile {
        match self {
            Self::Itself(file) => file,
            Self::Copy { file, .. } => file,
        }
    }
}

/// Returns whether a path is a log: a file with one of their endings, or a folder that holds such files.
pub fn is_log(path: &Path) -> bool {
    if path.is_dir() { !in_folder(path).is_empty() } else { LogFile::by_name(path).is_some() }
}

/// Finds the files of a log, in order of time.
pub(super) fn of_log(path: &Path) -> Result<Vec<LogFile>, LogError> {
    let metadata = fs::metadata(path).map_err(LogError::io(path))?;
    let files = if metadata.is_dir() {
        listed(path).filter(|files| !files.is_empty()).unwrap_or_else(|| in_folder(path))
    } else {
        LogFile::by_name(path).into_iter().collect()
    };
    if files.is_empty() { Err(LogError::new(path, LogFault::NotALog)) } else { Ok(files) }
}

/// Returns the files that a folder's `metadata.yaml` lists and that are there. A robot that is switched off writes none.
fn listed(folder: &Path) -> Option<Vec<LogFile>> {
    let path = folder.join("metadata.yaml");
    if fs::metadata(&path).ok()?.len() > MAX_METADATA_BYTES {
        return None;
    }
    let text = fs::read_to_string(path).ok()?;
    let after = text.lines().skip_while(|line| line.trim() != "relative_file_paths:").skip(1);
    let items = after.map_while(|line| line.trim().strip_prefix("- "));
    let inside = |name: &&str| Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    let names = items.map(|item| item.trim_matches(['"', '\''])).filter(inside);
    let files = names.map(|name| folder.join(name)).filter(|path| path.is_file());
    Some(files.filter_map(|path| LogFile::by_name(&path)).collect())
}

/// Returns the logs in a folder, sorted by the numbers that rosbag2 puts at the end of their names.
fn in_folder(folder: &Path) -> Vec<LogFile> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    paths.sort_by_key(|path| (number_in(path), path.clone()));
    paths.iter().filter_map(|path| LogFile::by_name(path)).collect()
}

/// Returns the number at the end of a file's name, without its endings.
fn number_in(path: &Path) -> u64 {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let name = name.split('.').next().unwrap_or_default();
    let digits = name.len() - name.trim_end_matches(|letter: char| letter.is_ascii_digit()).len();
    name[name.len() - digits..].parse().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_of_a_folder_are_sorted_by_their_numbers() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["walk_10.db3", "walk_2.db3", "walk_0.db3", "metadata.txt"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let names = |files: Vec<LogFile>| files.iter().map(|file| number_in(file.path())).collect::<Vec<_>>();
        assert_eq!(names(of_log(folder.path()).unwrap()), [0, 2, 10]);
        let listed = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - walk_2.db3\n    - ../walk_0.db3\n  duration:\n";
        fs::write(folder.path().join("metadata.yaml"), listed).unwrap();
        assert_eq!(names(of_log(folder.path()).unwrap()), [2]);
    }
}
