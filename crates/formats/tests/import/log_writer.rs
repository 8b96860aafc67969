//! Writer of logs for tests, by the packages `mcap` and `rusqlite`.

use std::{collections::BTreeMap, io::Cursor, path::Path};

use mcap::{Compression, WriteOptions, records::MessageHeader};
use rusqlite::{Connection, params};

/// How a topic's messages are encoded.
#[derive(Debug, Clone)]
pub struct Kind {
    pub type_name: &'static str,
    pub message_encoding: &'static str,
    pub schema_encoding: &'static str,
    pub schema: Vec<u8>,
}

impl Kind {
    pub fn cdr(type_name: &'static str, definition: &str) -> Self {
        Self {
            type_name,
            message_encoding: "cdr",
            schema_encoding: "ros2msg",
            schema: definition.as_bytes().to_vec(),
        }
    }

    pub fn json(type_name: &'static str, schema: &str) -> Self {
        Self {
            type_name,
            message_encoding: "json",
            schema_encoding: "jsonschema",
            schema: schema.as_bytes().to_vec(),
        }
    }
}

/// Messages in the order in which they are written.
#[derive(Debug, Clone, Default)]
pub struct Messages {
    kinds: BTreeMap<String, Kind>,
    messages: Vec<(String, i64, Vec<u8>)>,
}

impl Messages {
    pub fn add(&mut self, topic: &str, kind: &Kind, log_time_ns: i64, data: Vec<u8>) {
        self.kinds.entry(topic.to_owned()).or_insert_with(|| kind.clone());
        self.messages.push((topic.to_owned(), log_time_ns, data));
    }

    /// Keeps the messages of some topics.
    #[allow(dead_code, reason = "not every test that shares this file leaves topics out")]
    pub fn retain(&mut self, is_kept: impl Fn(&str) -> bool) {
        self.messages.retain(|(topic, ..)| is_kept(topic));
        self.kinds.retain(|topic, _| is_kept(topic));
    }

    /// Returns an MCAP file.
    pub fn mcap(&self, compression: Option<Compression>, chunk_bytes: Option<u64>) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let options = WriteOptions::new()
            .compression(compression)
            .chunk_size(chunk_bytes)
            .use_chunks(chunk_bytes.is_some());
        let mut writer = options.create(&mut file).unwrap();
        let mut channels = BTreeMap::new();
        for (topic, kind) in &self.kinds {
            let schema = writer.add_schema(kind.type_name, kind.schema_encoding, &kind.schema).unwrap();
            let channel = writer.add_channel(schema, topic, kind.message_encoding, &BTreeMap::new()).unwrap();
            channels.insert(topic.clone(), channel);
        }
        for (sequence, (topic, time_ns, data)) in self.messages.iter().enumerate() {
            let header = MessageHeader {
                channel_id: channels[topic],
                sequence: sequence as u32,
                log_time: *time_ns as u64,
                publish_time: *time_ns as u64,
            };
            writer.write_to_known_channel(&header, data).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        file.into_inner()
    }

    /// Writes a SQLite bag as ROS 2 Humble does: without definitions.
    pub fn write_db3(&self, path: &Path) {
        let connection = Connection::open(path).unwrap();
        let tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
            CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
            CREATE INDEX timestamp_idx ON messages (timestamp ASC);";
        connection.execute_batch(tables).unwrap();
        let ids: BTreeMap<&String, i64> = self.kinds.keys().zip(1..).collect();
        for (topic, kind) in &self.kinds {
            let insert = "INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', '')";
            connection.execute(insert, params![ids[topic], topic, kind.type_name]).unwrap();
        }
        connection.execute_batch("BEGIN").unwrap();
        for (topic, time_ns, data) in &self.messages {
            let insert = "INSERT INTO messages(topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
            connection.execute(insert, params![ids[topic], time_ns, data]).unwrap();
        }
        connection.execute_batch("COMMIT").unwrap();
    }
}
