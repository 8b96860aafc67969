//! An MCAP file that Foxglove opens.

use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use foxglove::{Context, FoxgloveError, McapCompression, McapWriteOptions, McapWriter, McapWriterHandle};
use tempfile::NamedTempFile;

use super::topics::Topics;
use crate::model_error::{ModelError, ModelFault};

/// Temporary files of logs that are not complete.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes the temporary files of all logs that are not complete. For a program that ends at once, as when it is interrupted: no
/// log can be finished afterwards.
pub fn remove_unfinished_logs() {
    for path in unfinished().drain(..) {
        // What cannot be removed stays; the program ends.
        let _ = fs::remove_file(path);
    }
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of names cannot be left in disorder by a panic.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// MCAP file that is being written. It gets its name when it is complete, by [`TopicFile::finish`]; dropped before, it leaves
/// nothing behind.
#[derive(Debug)]
pub struct TopicFile<T> {
    path: PathBuf,
    /// Holds what the writer belongs to.
    _context: Arc<Context>,
    topics: T,
    writer: McapWriterHandle<BufWriter<NamedTempFile>>,
}

impl<T: Topics> TopicFile<T> {
    /// Begins a file, under a temporary name in its folder; a symbolic link is followed. Fails if it cannot be written there, or if a
    /// device, a pipe or a folder has its name: a log is written with jumps back, which only a file allows.
    pub fn create(path: &Path) -> Result<Self, ModelError> {
        let unwritable = |error| ModelError::of_file(path, ModelFault::Unwritable(error));
        let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        if target.exists() && !target.is_file() {
            return Err(unwritable(io::Error::other("it is not a regular file")));
        }
        let path = target.as_path();
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let file = tempfile::Builder::new()
            .prefix(".unfinished-")
            .tempfile_in(folder.unwrap_or(Path::new(".")))
            .map_err(unwritable)?;
        unfinished().push(file.path().to_path_buf());
        let context = Context::new();
        let options = McapWriteOptions::new().compression(Some(McapCompression::Lz4)).profile(T::PROFILE);
        let writer = McapWriter::with_options(options).context(&context).create(BufWriter::new(file));
        let writer = writer.map_err(|error| unwritable(io::Error::other(error)))?;
        let topics = T::open(&context).map_err(|error| unwritable(io::Error::other(error)))?;
        Ok(Self { path: path.to_path_buf(), topics, _context: context, writer })
    }

    /// Writes a picture and everything that is shown of it.
    pub fn log(&self, shot: &T::Shot<'_>) {
        self.topics.log(shot);
    }

    /// Completes the file, and gives it its name. Fails if the disk is full.
    pub fn finish(self) -> Result<(), ModelError> {
        let path = self.path.clone();
        self.try_finish().map_err(|error| ModelError::of_file(&path, ModelFault::Unwritable(error)))
    }

    fn try_finish(self) -> io::Result<()> {
        let other = |error: FoxgloveError| io::Error::other(error);
        let mut writer = self.writer.close().map_err(other)?;
        writer.flush()?;
        let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.as_file().sync_all()?;
        // Temporary files are private; this one is no longer temporary.
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            fs::set_permissions(file.path(), fs::Permissions::from_mode(0o644))?;
        }
        let name = file.path().to_path_buf();
        // Held: an interruption removes the file, or finds it complete.
        let mut unfinished = unfinished();
        unfinished.retain(|path| *path != name);
        file.persist(&self.path)?;
        Ok(())
    }
}
