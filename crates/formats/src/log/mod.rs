//! Robots' logs: MCAP files, SQLite bags (`.db3`), and the folders of rosbag2 that hold either.
//!
//! Messages come in the order in which the log holds them, one at a time; a log of any length takes the memory of its largest
//! message. What a hostile file claims of its lengths is never believed: memory grows with what is there.

mod compressed;
mod error;
mod files;
mod mcap;
mod mcap_chunk;
mod mcap_records;
mod mcap_summary;
mod sqlite;
mod survey;
mod topic;

use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
    sync::Arc,
};

pub use self::{
    error::{LogError, LogFault},
    files::is_log,
    survey::{Survey, TopicSummary},
    topic::{Topic, TopicSet},
};
use self::{files::LogFile, mcap::read_mcap, sqlite::read_sqlite};

/// Message of a log.
#[derive(Debug, Clone, Copy)]
pub struct Message<'a> {
    /// Topic on which it was sent.
    pub topic: &'a Arc<Topic>,
    /// Time at which it was written to the log, nanoseconds.
    pub log_time_ns: i64,
    /// Bytes of the message.
    pub data: &'a [u8],
}

/// Receiver of a log's messages.
pub trait Sink {
    /// Returns whether messages of a topic are wanted. It is asked once for each topic of a file.
    fn wants(&mut self, topic: &Arc<Topic>) -> bool;

    /// Takes a message. Nothing more is read after `Break`.
    fn take(&mut self, message: Message<'_>) -> ControlFlow<()>;

    /// Returns whether contents of messages are wanted, too; without them `Message::data` may be empty.
    fn needs_contents(&self) -> bool {
        true
    }

    /// Learns how much of the log has been read, bytes.
    fn read_so_far(&mut self, _bytes: u64) {}
}

/// What was found at the end of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ending {
    /// Whether the log ends without its proper end, or a part of it is damaged: it was cut off.
    pub is_cut: bool,
    /// Length of what could not be read, bytes; within compressed parts an estimate.
    pub bytes_lost: u64,
}

impl Ending {
    pub(crate) fn joined(self, other: Self) -> Self {
        Self {
            is_cut: self.is_cut || other.is_cut,
            bytes_lost: self.bytes_lost.saturating_add(other.bytes_lost),
        }
    }
}

/// Robot's log.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    files: Vec<LogFile>,
}

impl Log {
    /// Finds the files of a log: a `.mcap` or `.db3`, or a folder of rosbag2. Fails if there is no such file, or if it is none.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        Ok(Self { path: path.to_path_buf(), files: files::of_log(path)? })
    }

    /// Returns the path of the log.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the paths of its files, in order of time.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(LogFile::path)
    }

    /// Returns the length of all its files, bytes.
    pub fn bytes(&self) -> u64 {
        self.files().map(|file| std::fs::metadata(file).map_or(0, |metadata| metadata.len())).sum()
    }

    /// Hands over all messages that are wanted. A log that was cut off is read up to its last whole message. Fails if a file
    /// cannot be read at all.
    pub fn read(&self, topics: &mut TopicSet, sink: &mut dyn Sink) -> Result<Ending, LogError> {
        let mut ending = Ending::default();
        let mut before = 0;
        for file in &self.files {
            let (flow, of_file) = match &*file.unpacked()? {
                LogFile::Mcap(path) => read_mcap(path, topics, &mut Offset { sink, before })?,
                LogFile::Sqlite(path) => read_sqlite(path, topics, &mut Offset { sink, before })?,
                LogFile::Packed(..) => continue,
            };
            ending = ending.joined(of_file);
            before += std::fs::metadata(file.path()).map_or(0, |metadata| metadata.len());
            if flow.is_break() {
                break;
            }
        }
        Ok(ending)
    }
}

/// Sink that counts the bytes of earlier files.
struct Offset<'a> {
    sink: &'a mut dyn Sink,
    before: u64,
}

impl Sink for Offset<'_> {
    fn wants(&mut self, topic: &Arc<Topic>) -> bool {
        self.sink.wants(topic)
    }

    fn take(&mut self, message: Message<'_>) -> ControlFlow<()> {
        self.sink.take(message)
    }

    fn needs_contents(&self) -> bool {
        self.sink.needs_contents()
    }

    fn read_so_far(&mut self, bytes: u64) {
        self.sink.read_so_far(self.before + bytes);
    }
}
