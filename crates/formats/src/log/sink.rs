//! Messages on their way out of a log.

use std::{ops::ControlFlow, sync::Arc};

use super::topic::Topic;

/// How reading a file or a part of one ended.
pub(super) type Outcome = (ControlFlow<()>, Ending);

/// Latest time that is believed, and with a minus the earliest, nanoseconds: the year 2096. Differences of two such times are numbers
/// of 64 bits.
pub const LATEST_NS: i64 = 4_000_000_000_000_000_000;

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
