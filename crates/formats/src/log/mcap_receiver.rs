//! Receiver of MCAP's records, in chunks or outside them.

use std::{
    io::{self, Read},
    ops::ControlFlow,
};

use mcap::records::op;

use super::{
    compressed::unpacked_message,
    mcap_records::{Channels, message},
    sink::{LATEST_NS, Message, Sink},
    topic::TopicSet,
};

/// Schemas and channels so far, and who gets the messages.
pub(super) struct Receiver<'a> {
    channels: Channels,
    topics: &'a mut TopicSet,
    sink: &'a mut dyn Sink,
    body: Vec<u8>,
}

impl<'a> Receiver<'a> {
    /// Makes a receiver that has met nothing yet.
    pub fn new(topics: &'a mut TopicSet, sink: &'a mut dyn Sink) -> Self {
        Self { channels: Channels::default(), topics, sink, body: Vec::new() }
    }

    /// Reads a record's body and takes what it holds. Fails with `UnexpectedEof` if the source ends before the record.
    pub fn record(&mut self, kind: u8, length: u64, source: &mut impl Read) -> io::Result<ControlFlow<()>> {
        self.body.clear();
        // Memory grows with what is there, not with what the length claims.
        source.take(length).read_to_end(&mut self.body)?;
        if (self.body.len() as u64) < length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        match kind {
            op::SCHEMA => drop(self.channels.add_schema(&self.body)),
            op::CHANNEL => drop(self.channels.add_channel(&self.body, self.topics, self.sink)),
            op::MESSAGE => return Ok(self.message()),
            _ => {}
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Says how much of the file has been read, bytes.
    pub fn read_so_far(&mut self, bytes: u64) {
        self.sink.read_so_far(bytes);
    }

    fn message(&mut self) -> ControlFlow<()> {
        let Some((channel, log_time_ns, data)) = message(&self.body) else {
            return ControlFlow::Continue(());
        };
        match self.channels.by_id.get(&channel) {
            Some(channel) if channel.is_wanted => {
                let data = &unpacked_message(data);
                let log_time_ns =
                    i64::try_from(log_time_ns).map_or(LATEST_NS, |time_ns| time_ns.min(LATEST_NS));
                self.sink.take(Message { topic: &channel.topic, log_time_ns, data })
            }
            _ => ControlFlow::Continue(()),
        }
    }
}
