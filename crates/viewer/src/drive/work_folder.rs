//! The folder of a database that is there only for as long as it is looked at.

use std::{
    fs::{self, File},
    io,
    path::Path,
};

use tempfile::TempDir;

/// What such folders' names begin with; the process and a few letters by chance follow.
const PREFIX: &str = "reality-sim-viewer-";
/// The file in it that its process has locked. The system lets go of the lock however the process ends.
const LOCK: &str = "in-use";

/// A temporary folder that is deleted with this. Where the process is killed before, the next one to make such a folder
/// deletes it.
#[derive(Debug)]
pub struct WorkFolder {
    /// Before the folder: files that are open cannot be deleted everywhere.
    _lock: File,
    folder: TempDir,
}

impl WorkFolder {
    /// A new folder in another one, out of which those that nobody uses any more are swept.
    pub fn new_in(parent: &Path) -> io::Result<Self> {
        sweep(parent);
        let prefix = format!("{PREFIX}{}-", std::process::id());
        let folder = tempfile::Builder::new().prefix(&prefix).tempdir_in(parent)?;
        let lock = File::create_new(folder.path().join(LOCK))?;
        // Where nothing can be locked, nobody else can either: nothing is swept there.
        let _ = lock.lock();
        Ok(Self { _lock: lock, folder })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

fn sweep(parent: &Path) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let is_such = entry.file_name().to_str().is_some_and(|name| name.starts_with(PREFIX));
        if is_such && is_abandoned(&entry.path()) {
            // What cannot be deleted, as another's, stays.
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
    fn a_folder_goes_with_its_owner_and_its_name_tells_whose_it_is() {
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
        // As a process leaves it that has no time to clean up: the file is there, and nobody holds its lock.
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
