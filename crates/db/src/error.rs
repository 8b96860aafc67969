//! What can be wrong with a database: which file, what it is, and what to do about it, in one line.

use std::{
    io,
    path::{Path, PathBuf},
};

use reality_sim_core::sequence::{Printable, SequenceError};
use rusqlite::{ErrorCode, ffi};

/// A database, or a recording on its way into one, that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DbError {
    /// The fault is the database's.
    #[error("{}: {fault}", Printable(.path))]
    Database {
        /// The database.
        path: PathBuf,
        /// What is wrong.
        fault: DbFault,
    },
    /// The fault is one of a recording's files, or of a picture, camera or field in the database. The error's path is
    /// then the database's with ", image 12" behind it.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
}

impl DbError {
    /// A fault of the database at this path.
    pub(crate) fn new(path: &Path, fault: impl Into<DbFault>) -> Self {
        Self::Database { path: path.to_path_buf(), fault: fault.into() }
    }
}

/// What is wrong with a database, or with what is done to it. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DbFault {
    /// There is no such file.
    #[error("there is no such file: check the path, or build the database first")]
    Missing,
    /// A folder, pipe or device where a file is needed.
    #[error("is not a regular file: give the database's file")]
    NotAFile,
    /// Neither reading nor creating the file is possible.
    #[error("cannot be opened ({message}): check that its folder exists, and the permissions of both")]
    CannotOpen {
        /// What SQLite or the operating system says.
        message: String,
    },
    /// Any other file, an empty one, or the database of another program.
    #[error(
        "is not an image database of this program: check the path, or build the database into another file"
    )]
    NotADatabase,
    /// The program is older than the file.
    #[error("is of schema version {found} and this program knows versions up to {known}: update the program")]
    Newer {
        /// Of the file.
        found: i64,
        /// Of the program.
        known: i64,
    },
    /// The program is newer than the file, which was opened for reading.
    #[error(
        "is of the old schema version {found}: open it once for writing, which brings it to version {known}"
    )]
    Older {
        /// Of the file.
        found: i64,
        /// Of the program.
        known: i64,
    },
    /// The file ends too early.
    #[error("is cut off: it has {found_bytes} bytes of {expected_bytes}; copy it again, or build it again")]
    Truncated {
        /// Length of the file.
        found_bytes: u64,
        /// Length by the file's header.
        expected_bytes: u64,
    },
    /// Damage that SQLite finds.
    #[error("is damaged ({message}): copy it again, or build it again")]
    Damaged {
        /// What SQLite says.
        message: String,
    },
    /// A row that no program of this version writes.
    #[error("is damaged ({table} {id}: {problem}): copy it again, or build it again")]
    BadRow {
        /// What the row holds.
        table: &'static str,
        /// Of the row.
        id: i64,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// Another program or thread holds a lock, and goes on doing so.
    #[error("is locked by another program that writes or reads it: wait until that is done, then try again")]
    Locked,
    /// Neither the file nor its folder can be changed.
    #[error("cannot be written: check the permissions of the file and of its folder")]
    ReadOnly,
    /// A time that is no number.
    #[error("the time of frame {frame_index} is no finite number: give seconds of the recording's clock")]
    TimeImpossible {
        /// Number of the frame, from 0.
        frame_index: usize,
    },
    /// This program opened it for reading.
    #[error("was opened for reading: open it for writing to add pictures")]
    OpenedForReading,
    /// A writer was killed, and what it left cannot be tidied up.
    #[error(
        "a writer was killed and left a journal, which cannot be undone where nothing can be written: copy the file and its journal to another folder and open it there"
    )]
    UnfinishedWrite,
    /// No space.
    #[error("the disk is full: make space, then start again; what is in it stays")]
    DiskFull,
    /// The operating system does not give or take the bytes.
    #[error("cannot be read or written ({message}): check the disk")]
    Io {
        /// What SQLite says.
        message: String,
    },
    /// An image that is not there.
    #[error("there is no image {id}: take one that the list of images holds")]
    NoSuchImage {
        /// As asked.
        id: i64,
    },
    /// A frame that is in the database in another form.
    #[error(
        "frame {frame_index} of the sequence {sequence:?} is in it with another {what}: the sequence was changed, build it into a new file, or give it another name in sequence.toml"
    )]
    Changed {
        /// The sequence's name.
        sequence: String,
        /// Of the frame, from 0.
        frame_index: usize,
        /// What differs.
        what: &'static str,
    },
    /// Not one entry a frame.
    #[error("{found} poses were given for the {expected} frames of a sequence: give one entry a frame")]
    PoseCount {
        /// As given.
        found: usize,
        /// Frames of the sequence.
        expected: usize,
    },
    /// A pose that no camera can have, see [`reality_sim_core::pose::CameraPose::is_possible`], or a covariance with NaN or infinity.
    #[error(
        "the pose given for frame {frame_index} is none that a camera can have (finite numbers, above the ground, within 200 m): correct it, or leave it out"
    )]
    PoseImpossible {
        /// Of the frame, from 0.
        frame_index: usize,
    },
    /// A picture's file name that is not Unicode.
    #[error("the picture's name of frame {frame_index} is not UTF-8: rename the picture")]
    NameNotUtf8 {
        /// Of the frame, from 0.
        frame_index: usize,
    },
}

impl From<rusqlite::Error> for DbFault {
    fn from(error: rusqlite::Error) -> Self {
        let message = one_line(&error);
        let extended = error.sqlite_error().map_or(0, |error| error.extended_code);
        match error.sqlite_error_code() {
            Some(ErrorCode::NotADatabase) => Self::NotADatabase,
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => Self::Locked,
            Some(ErrorCode::ReadOnly) if extended == ffi::SQLITE_READONLY_ROLLBACK => Self::UnfinishedWrite,
            Some(ErrorCode::ReadOnly) => Self::ReadOnly,
            Some(ErrorCode::DiskFull) => Self::DiskFull,
            Some(ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => Self::CannotOpen { message },
            Some(ErrorCode::SystemIoFailure) => Self::Io { message },
            // The tables are this program's own: what does not fit them is damage.
            _ => Self::Damaged { message },
        }
    }
}

impl From<io::Error> for DbFault {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::NotFound {
            Self::Missing
        } else {
            Self::CannotOpen { message: error.to_string() }
        }
    }
}

/// SQLite's message, without the line breaks of the statement that it may quote.
fn one_line(error: &rusqlite::Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
