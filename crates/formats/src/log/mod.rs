//! Robots' logs: MCAP files, SQLite bags (`.db3`), and the folders of rosbag2 that hold either.
//!
//! Messages come in the order in which the log holds them, one at a time; a log of any length takes the memory of its largest
//! message. What a hostile file claims of its lengths is never believed: memory grows with what is there.

mod compressed;
mod error;
mod files;
mod mcap;
mod mcap_chunk;
mod mcap_receiver;
mod mcap_records;
mod mcap_summary;
mod sink;
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
    sink::{Ending, LATEST_NS, Message, Sink},
    survey::{Survey, TopicSummary},
    topic::{Topic, TopicSet},
};
use self::{files::LogFile, mcap::read_mcap, sqlite::read_sqlite};

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
