//! Files that have their name only when they are complete.

use std::{
    io::{self, Write},
    path::Path,
};

use super::error::{Fault, SequenceError};

/// Writes a file under a temporary name in its folder, then gives it its name: whoever is killed in between, or runs
/// out of disk, leaves the old file or none.
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

/// Temporary files are private by default; a finished file has the permissions of any other.
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
