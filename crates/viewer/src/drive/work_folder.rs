//! Folder of a temporary database.

use std::{
    fs::{self, File},
    io,
    path::Path,
};

use tempfile::TempDir;

/// Prefix of the folder's name; the process id and random letters follow.
const PREFIX: &str = "reality-sim-viewer-";
/// File in the folder that its process has locked. The system releases the lock however the process ends.
const LOCK: &str = "in-use";

/// Temporary folder that is deleted when this is dropped. If the process is killed before, the next one to make such a
/// folder deletes it.
#[derive(Debug)]
pub struct WorkFolder {
    /// Declared before the folder: some systems cannot delete open files.
    _lock: File,
    folder: TempDir,
}

impl WorkFolder {
    /// Makes a new folder inside `parent`, and deletes those that are no longer in use.
    pub fn new_in(parent: &Path) -> io::Result<Self> {
        sweep(parent);
        let prefix = format!("{PREFIX}{}-", std::process::id());
        let folder = tempfile::Builder::new().prefix(&prefix).tempdir_in(parent)?;
        let lock = File::create_new(folder.path().join(LOCK))?;
        // Where files cannot be locked, nothing can be told to be unused, and nothing is deleted.
        let _ = lock.lock();
        Ok(Self { _lock: lock, folder })
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

fn sweep(parent: &Path) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let is_such = entry.file_name().to_str().is_some_and(|name| name.starts_with(PREFIX));
        if is_such && is_abandoned(&entry.path()) {
            // A folder that cannot be deleted, as another user's, stays.
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

fn is_abandoned(folder: &Path) -> bool {
    File::open(folder.join(LOCK)).is_ok_and(|lock| lock.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_folder_is_deleted_with_its_owner_and_bears_its_process_id() {
        let parent = tempfile::tempdir().unwrap();
        let folder = WorkFolder::new_in(parent.path()).unwrap();
        let prefix = format!("reality-sim-viewer-{}-", std::process::id());
        assert!(names_in(parent.path())[0].starts_with(&prefix));
        fs::write(folder.path().join("recording.db"), "pictures").unwrap();
        drop(folder);
        assert!(names_in(parent.path()).is_empty());
    }

    #[test]
    fn folders_of_processes_that_were_killed_are_swept_and_no_others() {
        let parent = tempfile::tempdir().unwrap();
        // State left by a killed process: the file is there, and nobody holds its lock.
        let killed = parent.path().join("reality-sim-viewer-1-killed");
        let others = parent.path().join("photographs");
        for folder in [&killed, &others] {
            fs::create_dir(folder).unwrap();
            fs::write(folder.join(LOCK), "").unwrap();
            fs::write(folder.join("recording.db"), "pictures").unwrap();
        }
        let first = WorkFolder::new_in(parent.path()).unwrap();
        assert!(!killed.exists() && others.join("recording.db").exists());
        let second = WorkFolder::new_in(parent.path()).unwrap();
        assert!(first.path().exists() && second.path().exists(), "what is in use stays");
    }
}
