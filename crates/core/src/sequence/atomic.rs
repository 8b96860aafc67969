//! Atomic writing: a file gets its name only when it is complete.

use std::{
    io::{self, Write},
    path::Path,
};

use super::error::{Fault, SequenceError};

/// Writes a file under a temporary name in its folder, then renames it. If the program is killed in between or the disk
/// is full, the old file or none remains. Fails if the operating system does not allow it.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), SequenceError> {
    try_write(path, bytes).map_err(|error| SequenceError::of_file(path, Fault::Unwritable(error)))
}

fn try_write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut file = builder().tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

/// Returns a builder of temporary files with the usual permissions; by default they are private.
#[cfg(unix)]
fn builder() -> tempfile::Builder<'static, 'static> {
    use std::{fs::Permissions, os::unix::fs::PermissionsExt};
    let mut builder = tempfile::Builder::new();
    builder.prefix(".unfinished-").permissions(Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".unfinished-");
    builder
}
