//! Atomic writing: a file gets its name only when it is complete.

use std::{
    fs::{self, OpenOptions},
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{PoisonError, RwLock, RwLockWriteGuard},
};

use super::error::{Fault, SequenceError};

/// Largest number of symbolic links that are followed one after the other, as in Linux's `path_resolution(7)`.
const MOST_LINKS: usize = 40;

/// Held for reading while a file is written.
static WRITING: RwLock<()> = RwLock::new(());

/// Writes a file under a temporary name in its folder, then renames it. If the program is killed in between or the disk
/// is full, the old file or none remains.
///
/// A symbolic link stays, and the file that it leads to is written. Pipes, devices and what lies under `/dev` or `/proc` are
/// written into, since a rename would put a file in their place. Fails if the operating system does not allow it.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), SequenceError> {
    write_atomically_with(path, |file| file.write_all(bytes))
}

/// Works like [`write_atomically`] for a file that need not fit into memory: `write` writes it piece by piece.
pub fn write_atomically_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), SequenceError> {
    try_write(path, write).map_err(|error| SequenceError::of_file(path, Fault::Unwritable(error)))
}

/// Waits until the files that are being written have their names, and lets none be begun while the guard is held. A program that
/// ends with it, as when it is interrupted, leaves no unfinished file behind.
pub fn hold_writing() -> RwLockWriteGuard<'static, ()> {
    // The lock guards no data that a panic could have left in disorder.
    WRITING.write().unwrap_or_else(PoisonError::into_inner)
}

fn try_write(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    match Target::of(path)? {
        Target::File(path) => {
            let _writing = WRITING.read().unwrap_or_else(PoisonError::into_inner);
            replace(&path, write)
        }
        // Behind what the stream holds: standard output may be a file that other programs write to.
        Target::Stream => write(&mut OpenOptions::new().append(true).open(path)?),
    }
}

/// What a path leads to.
enum Target {
    /// A regular file, or nothing yet, at the end of all symbolic links.
    File(PathBuf),
    /// A pipe, a socket or a device, perhaps one of this process.
    Stream,
}

impl Target {
    fn of(path: &Path) -> io::Result<Self> {
        let mut path = path.to_path_buf();
        for _ in 0..MOST_LINKS {
            if is_of_the_system(&path) {
                return Ok(Self::Stream);
            }
            match fs::symlink_metadata(&path) {
                Ok(metadata) if metadata.is_symlink() => path = parent(&path).join(fs::read_link(&path)?),
                Ok(metadata) if metadata.is_file() => return Ok(Self::File(path)),
                Ok(metadata) if metadata.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
                Ok(_) => return Ok(Self::Stream),
                Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::File(path)),
                Err(error) => return Err(error),
            }
        }
        Err(io::Error::other("too many symbolic links"))
    }
}

/// Returns whether a path lies where the operating system shows devices and processes: `/dev/stdout` may lead to a regular
/// file, but writing to it is writing to a stream.
fn is_of_the_system(path: &Path) -> bool {
    let folder = parent(path).canonicalize();
    folder.is_ok_and(|folder| {
        (folder.starts_with("/dev") && !folder.starts_with("/dev/shm")) || folder.starts_with("/proc")
    })
}

/// Puts a file in the place of another one, or of none.
fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = builder().tempfile_in(parent(path))?;
    write(&mut file)?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
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

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use std::{
        os::unix::fs::{FileTypeExt, symlink},
        process::Command,
        thread,
    };

    use super::*;

    fn is_link(path: &Path) -> bool {
        fs::symlink_metadata(path).unwrap().is_symlink()
    }

    #[test]
    fn a_symbolic_link_stays_and_its_file_is_written() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("far")).unwrap();
        for existing in [true, false] {
            let (file, link) =
                (folder.path().join("far/file"), folder.path().join(format!("link {existing}")));
            if existing {
                fs::write(&file, "old and longer").unwrap();
            } else {
                fs::remove_file(&file).unwrap();
            }
            symlink("far/file", &link).unwrap();
            write_atomically(&link, b"new").unwrap();
            assert!(is_link(&link));
            assert_eq!(fs::read(&file).unwrap(), b"new");
        }
    }

    #[test]
    fn links_that_lead_to_each_other_are_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        symlink(&a, &b).unwrap();
        symlink(&b, &a).unwrap();
        assert!(write_atomically(&a, b"new").is_err());
        assert!(is_link(&a) && is_link(&b));
    }

    #[test]
    fn a_pipe_stays_and_gets_the_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let read = thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        write_atomically(&pipe, b"new").unwrap();
        assert_eq!(read.join().unwrap(), b"new");
        assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
    }

    // Through a link, since what this test fails for would replace the machine's own device.
    #[test]
    fn a_link_to_a_device_stays() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        symlink("/dev/null", &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert!(is_link(&link));
        assert!(fs::metadata(&link).unwrap().file_type().is_char_device());
    }

    #[test]
    fn a_folder_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write_atomically(folder.path(), b"new").is_err());
        assert!(folder.path().is_dir());
    }
}
