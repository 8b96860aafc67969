//! Errors of logs: the message says in one line which file, what is wrong and what to do.

use std::{
    io,
    path::{Path, PathBuf},
};

use reality_sim_core::sequence::{Printable, on_one_line};

/// Reason why a log cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", Printable(.path))]
pub struct LogError {
    /// Path of the file or folder.
    pub path: PathBuf,
    /// Fault of the file or folder.
    #[source]
    pub fault: LogFault,
}

impl LogError {
    /// Makes an error about a file or folder.
    pub fn new(path: &Path, fault: LogFault) -> Self {
        Self { path: path.to_path_buf(), fault }
    }

    /// Makes an error of the operating system.
    pub(super) fn io(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        |error| {
            let fault = match error.kind() {
                io::ErrorKind::NotFound => LogFault::Missing,
                _ => LogFault::Unreadable(error),
            };
            Self::new(path, fault)
        }
    }
}

/// Fault of a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogFault {
    /// The file or folder does not exist.
    #[error("there is no such file or folder: check the path")]
    Missing,
    /// The operating system cannot read the file.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(#[source] io::Error),
    /// The file is not of a kind that is read.
    #[error("is no log that can be read: give a .mcap, a .db3, or a rosbag2 folder that holds such files")]
    NotALog,
    /// The file does not begin as MCAP.
    #[error("is not an MCAP file: its first bytes are others, check what it is")]
    NotMcap,
    /// The file is not a database of rosbag2.
    #[error("is not a SQLite bag of rosbag2 ({}): check what it is, or record it again as MCAP", on_one_line(.0))]
    NotABag(String),
    /// The compressed file cannot be unpacked.
    #[error("cannot be unpacked ({0}): unpack it with `zstd -d`")]
    Packed(#[source] io::Error),
}
