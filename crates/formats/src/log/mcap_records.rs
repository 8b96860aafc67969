//! Records of MCAP that hold what is read: schemas, channels, messages and the beginning of chunks. Lengths in a file are
//! claims: nothing is allocated by them. <https://mcap.dev/spec>

use std::collections::HashMap;
use std::sync::Arc;

use super::{
    sink::Sink,
    topic::{Topic, TopicSet},
};
use crate::schema::RawDefinition;

/// Length of a record's kind and length, bytes.
pub(super) const RECORD_HEADER_BYTES: usize = 9;

/// Splits a record's header into kind and length.
pub(super) fn record_header(bytes: [u8; RECORD_HEADER_BYTES]) -> (u8, u64) {
    let [kind, length @ ..] = bytes;
    (kind, u64::from_le_bytes(length))
}

/// Bytes of a record, read from the front.
pub(super) struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    pub fn u16(&mut self) -> Option<u16> {
        self.take(2)?.try_into().ok().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.take(4)?.try_into().ok().map(u32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Option<u64> {
        self.take(8)?.try_into().ok().map(u64::from_le_bytes)
    }

    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        let count = self.u32()? as usize;
        self.take(count)
    }

    pub fn text(&mut self) -> Option<&'a str> {
        std::str::from_utf8(self.bytes()?).ok()
    }
}

/// Definition of messages, as a schema record holds it.
#[derive(Debug, Default)]
struct Schema {
    name: String,
    encoding: String,
    data: Vec<u8>,
}

/// Channel of a file, and whether its messages are wanted.
#[derive(Debug)]
pub(super) struct Channel {
    pub topic: Arc<Topic>,
    pub is_wanted: bool,
}

/// Schemas and channels that have been met in a file.
#[derive(Debug, Default)]
pub(super) struct Channels {
    schemas: HashMap<u16, Schema>,
    pub(super) by_id: HashMap<u16, Channel>,
}

impl Channels {
    /// Takes a schema record; a damaged one is left out.
    pub fn add_schema(&mut self, record: &[u8]) -> Option<()> {
        let mut fields = Fields(record);
        let id = fields.u16()?;
        if self.schemas.contains_key(&id) {
            return Some(());
        }
        let (name, encoding) = (fields.text()?.to_owned(), fields.text()?.to_owned());
        let data = fields.bytes()?.to_vec();
        self.schemas.insert(id, Schema { name, encoding, data });
        Some(())
    }

    /// Takes a channel record; a damaged one is left out.
    pub fn add_channel(&mut self, record: &[u8], topics: &mut TopicSet, sink: &mut dyn Sink) -> Option<()> {
        let mut fields = Fields(record);
        let (id, schema) = (fields.u16()?, fields.u16()?);
        if self.by_id.contains_key(&id) {
            return Some(());
        }
        let (name, message_encoding) = (fields.text()?, fields.text()?);
        let nothing = Schema::default();
        let schema = self.schemas.get(&schema).unwrap_or(&nothing);
        let raw = RawDefinition {
            message_encoding,
            schema_encoding: &schema.encoding,
            type_name: &schema.name,
            data: &schema.data,
        };
        let topic = topics.topic(name, raw);
        let is_wanted = sink.wants(&topic);
        self.by_id.insert(id, Channel { topic, is_wanted });
        Some(())
    }
}

/// Message record: channel, time at which it was logged in nanoseconds, and contents.
pub(super) fn message(record: &[u8]) -> Option<(u16, u64, &[u8])> {
    let mut fields = Fields(record);
    let channel = fields.u16()?;
    let _sequence = fields.u32()?;
    let log_time_ns = fields.u64()?;
    let _publish_time_ns = fields.u64()?;
    Some((channel, log_time_ns, fields.0))
}
