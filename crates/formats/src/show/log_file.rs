//! An MCAP file that Foxglove opens.

use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::Arc,
};

use foxglove::{Context, FoxgloveError, McapCompression, McapWriteOptions, McapWriter, McapWriterHandle};
use tempfile::NamedTempFile;

use super::{Shot, channels::Channels};
use crate::model_error::{ModelError, ModelFault};

/// MCAP file that is being written. It gets its name when it is complete, by [`LogFile::finish`]; dropped before, it leaves
/// nothing behind.
#[derive(Debug)]
pub struct LogFile {
    path: PathBuf,
    /// Holds what the writer belongs to.
    _context: Arc<Context>,
    channels: Channels,
    writer: McapWriterHandle<BufWriter<NamedTempFile>>,
}

impl LogFile {
    /// Begins a file, under a temporary name in its folder. Fails if it cannot be written there.
    pub fn create(path: &Path) -> Result<Self, ModelError> {
        let unwritable = |error| ModelError::of_file(path, ModelFault::Unwritable(error));
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let file = tempfile::Builder::new()
            .prefix(".unfinished-")
            .tempfile_in(folder.unwrap_or(Path::new(".")))
            .map_err(unwritable)?;
        let context = Context::new();
        let options = McapWriteOptions::new().compression(Some(McapCompression::Lz4));
        let writer = McapWriter::with_options(options).context(&context).create(BufWriter::new(file));
        let writer = writer.map_err(|error| unwritable(io::Error::other(error)))?;
        Ok(Self { path: path.to_path_buf(), channels: Channels::new(&context), _context: context, writer })
    }

    /// Writes a picture and everything that is shown of it.
    pub fn log(&self, shot: &Shot<'_>) {
        self.channels.log(shot);
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
        file.persist(&self.path)?;
        Ok(())
    }
}
