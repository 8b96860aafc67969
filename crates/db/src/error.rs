//! Errors of a database: which file, what is wrong with it, and the remedy, in one line.

use std::{
    error::Error,
    io,
    path::{Path, PathBuf},
};

use reality_sim_core::sequence::{Printable, SequenceError, counted, one_line};
use rusqlite::{ErrorCode, ffi};

/// Error of a database, or of a recording that is being stored in one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DbError {
    /// The fault is in the database itself.
    #[error("{}: {fault}", Printable(.path))]
    Database {
        /// Path of the database.
        path: PathBuf,
        /// What is wrong.
        #[source]
        fault: DbFault,
    },
    /// The fault is in one of a recording's files, or in a picture, camera or field in the database. In the latter case
    /// the error's path is the database's, followed by ", image 12" or the like.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
}

impl DbError {
    /// Makes the error of a fault in the database at this path.
    pub(crate) fn new(path: &Path, fault: impl Into<DbFault>) -> Self {
        Self::Database { path: path.to_path_buf(), fault: fault.into() }
    }
}

/// What is wrong with a database, or with an operation on it. Every message names the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DbFault {
    /// The file does not exist.
    #[error("there is no such file: check the path, or build the database first")]
    Missing,
    /// The path is a folder, pipe or device, not a file.
    #[error("is not a regular file: give the database's file")]
    NotAFile,
    /// The file can be neither read nor created.
    #[error("cannot be opened ({}): check that its folder exists, and the permissions of both", one_line(.source))]
    CannotOpen {
        /// Error of SQLite or the operating system.
        source: Box<dyn Error + Send + Sync>,
    },
    /// The file is of another kind, empty, or another program's database.
    #[error(
        "is not an image database of this program: check the path, or build the database into another file"
    )]
    NotADatabase,
    /// Nothing was ever stored in the file, as where its writer was killed before it had stored the first picture.
    #[error("holds nothing yet: build the database again into the same file")]
    NothingStored,
    /// The file has a newer schema version than this program knows.
    #[error("is of schema version {found} and this program knows versions up to {known}: update the program")]
    Newer {
        /// Schema version of the file.
        found: i64,
        /// Schema version of the program.
        known: i64,
    },
    /// The file has an older schema version and was opened for reading.
    #[error(
        "is of the old schema version {found}: open it once for writing, which brings it to version {known}"
    )]
    Older {
        /// Schema version of the file.
        found: i64,
        /// Schema version of the program.
        known: i64,
    },
    /// The file ends too early.
    #[error("is cut off: it has {found_bytes} bytes of {expected_bytes}; copy it again, or build it again")]
    Truncated {
        /// Length of the file, bytes.
        found_bytes: u64,
        /// Length stated in the file's header, bytes.
        expected_bytes: u64,
    },
    /// SQLite has found damage.
    #[error("is damaged ({}): copy it again, or build it again", one_line(.source))]
    Damaged {
        /// Error of SQLite.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A row contains something that no program of this version writes.
    #[error("is damaged ({table} {id}: {problem}): copy it again, or build it again")]
    BadRow {
        /// Content of the row.
        table: &'static str,
        /// Id of the row.
        id: i64,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A picture cannot be encoded.
    #[error("a picture cannot be encoded ({}): report this fault", one_line(.source))]
    Encoding {
        /// Error of the encoder.
        source: Box<dyn Error + Send + Sync>,
    },
    /// Another program or thread holds a lock for too long.
    #[error("is locked by another program that writes or reads it: wait until that is done, then try again")]
    Locked,
    /// Neither the file nor its folder can be changed.
    #[error("cannot be written: check the permissions of the file and of its folder")]
    ReadOnly,
    /// A time is not a finite number.
    #[error("the time of frame {frame_index} is no finite number: give seconds of the recording's clock")]
    TimeImpossible {
        /// Number of the frame, from 0.
        frame_index: usize,
    },
    /// The file was opened for reading only.
    #[error("was opened for reading: open it for writing to add pictures")]
    OpenedForReading,
    /// A killed writer left a journal that cannot be rolled back.
    #[error(
        "a writer was killed and left a journal, which cannot be undone where nothing can be written: copy the file and its journal to another folder and open it there"
    )]
    UnfinishedWrite,
    /// The disk is full.
    #[error("the disk is full: make space, then start again; what is in it stays")]
    DiskFull,
    /// The operating system failed to read or write.
    #[error("cannot be read or written ({}): check the disk", one_line(.source))]
    Io {
        /// Error of SQLite.
        source: Box<dyn Error + Send + Sync>,
    },
    /// The image does not exist.
    #[error("there is no image {id}: take one that the list of images holds")]
    NoSuchImage {
        /// Id that was asked for.
        id: i64,
    },
    /// Reading or writing took far more work than a file of this size can need.
    #[error(
        "is damaged, or was made to be slow (it takes more work than a database of its size): copy it again, or build it again"
    )]
    TooMuchWork,
    /// No sequence has this name.
    #[error("holds no sequence of the name {name:?}: check the name")]
    NoSuchSequence {
        /// Name that was asked for.
        name: String,
    },
    /// The tables are not those that this program makes.
    #[error(
        "is damaged, or was made by another program (its {kind} {name:?} is not as this program makes it): copy it again, or build it again"
    )]
    ForeignSchema {
        /// Kind of the part: table, view, trigger.
        kind: String,
        /// Name of the part.
        name: String,
    },
    /// The database already holds the frame with other contents.
    #[error(
        "frame {frame_index} of the sequence {sequence:?} is in it with another {what}: the sequence was changed, build it into a new file, or give it another name in sequence.toml"
    )]
    Changed {
        /// Name of the sequence.
        sequence: String,
        /// Number of the frame, from 0.
        frame_index: usize,
        /// Part that differs.
        what: &'static str,
    },
    /// Pictures of the recording are missing or damaged; its others are stored.
    #[error("holds the recording's other {}; {source}", counted(*.stored, "picture"))]
    LeftOut {
        /// Number of pictures of the recording that the database holds.
        stored: usize,
        /// The pictures, and what is wrong with them.
        source: Box<SequenceError>,
    },
    /// The number of poses is not the number of frames.
    #[error("{found} poses were given for the {expected} frames of a sequence: give one entry a frame")]
    PoseCount {
        /// Number of poses given.
        found: usize,
        /// Number of frames of the sequence.
        expected: usize,
    },
    /// The pose is impossible for a camera, see [`reality_sim_core::pose::CameraPose::is_possible`], or its covariance
    /// contains NaN or infinity.
    #[error(
        "the pose given for frame {frame_index} is none that a camera can have (finite numbers, above the ground, within 200 m): correct it, or leave it out"
    )]
    PoseImpossible {
        /// Number of the frame, from 0.
        frame_index: usize,
    },
    /// The file name of a picture is not valid Unicode.
    #[error("the picture's name of frame {frame_index} is not UTF-8: rename the picture")]
    NameNotUtf8 {
        /// Number of the frame, from 0.
        frame_index: usize,
    },
}

impl DbFault {
    /// Returns whether the disk or the operating system failed, and not the database or what was asked of it: the same may succeed on another
    /// machine, or later.
    pub fn is_of_machine(&self) -> bool {
        matches!(
            self,
            Self::CannotOpen { .. }
                | Self::Locked
                | Self::ReadOnly
                | Self::DiskFull
                | Self::Io { .. }
                | Self::UnfinishedWrite
        )
    }
}

impl From<rusqlite::Error> for DbFault {
    fn from(error: rusqlite::Error) -> Self {
        let extended = error.sqlite_error().map_or(0, |error| error.extended_code);
        match error.sqlite_error_code() {
            Some(ErrorCode::NotADatabase) => Self::NotADatabase,
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => Self::Locked,
            Some(ErrorCode::ReadOnly) if extended == ffi::SQLITE_READONLY_ROLLBACK => Self::UnfinishedWrite,
            Some(ErrorCode::ReadOnly) => Self::ReadOnly,
            Some(ErrorCode::DiskFull) => Self::DiskFull,
            Some(ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => {
                Self::CannotOpen { source: error.into() }
            }
            Some(ErrorCode::OperationInterrupted) => Self::TooMuchWork,
            Some(ErrorCode::SystemIoFailure) => Self::Io { source: error.into() },
            // The tables are this program's own: contents that do not fit them are damage.
            _ => Self::Damaged { source: error.into() },
        }
    }
}

impl From<image::ImageError> for DbFault {
    fn from(error: image::ImageError) -> Self {
        Self::Encoding { source: error.into() }
    }
}

impl From<io::Error> for DbFault {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::NotFound {
            Self::Missing
        } else {
            Self::CannotOpen { source: error.into() }
        }
    }
}
