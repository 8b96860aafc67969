//! SQLite bags of rosbag2 (`.db3`), read as files of unknown origin, <https://www.sqlite.org/security.html>. Rows come in the
//! order in which they were written.

use std::{
    collections::HashMap,
    fs,
    io::Read,
    ops::ControlFlow,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use rusqlite::{Connection, OpenFlags, Row, Statement, limits::Limit};

use super::{
    compressed::unpacked_message,
    error::{LogError, LogFault},
    sink::{Ending, LATEST_NS, Message, Outcome, Sink},
    topic::{Topic, TopicSet},
};
use crate::schema::RawDefinition;

/// Instructions of SQLite between two looks at the limit.
const STEP: i32 = 10_000;

/// Instructions that a file may take: so many whatever its size, and so many for each byte.
const WORK: (u64, u64) = (10_000_000, 4);

/// Rows that may be missing one after the other before a damaged file is given up.
const MAX_MISSING_ROWS: i64 = 2_000;

/// Topics of a file by their numbers; those that are wanted.
type WantedTopics = HashMap<i64, Arc<Topic>>;

/// Reads a file's messages, those before and behind damaged places, too.
pub(super) fn read_sqlite(
    path: &Path,
    topics: &mut TopicSet,
    sink: &mut dyn Sink,
) -> Result<Outcome, LogError> {
    let length = fs::metadata(path).map_err(LogError::io(path))?.len();
    let missing = missing_bytes(path, length)?;
    let fail = |error: rusqlite::Error| LogError::new(path, LogFault::NotABag(error.to_string()));
    let connection = open(path, length, missing > 0).map_err(fail)?;
    let wanted = wanted_topics(&connection, topics, sink).map_err(fail)?;
    let mut reader = Reader { wanted, sink, length, last_id: 0, bytes: 0 };
    let (flow, is_damaged) = reader.read(&connection).map_err(fail)?;
    let lost = if is_damaged { missing.max(1) } else { missing };
    Ok((flow, Ending { is_cut: is_damaged || missing > 0, bytes_lost: lost }))
}

/// Returns how much shorter a file is than its header says, bytes. Fails if it is not SQLite.
fn missing_bytes(path: &Path, length: u64) -> Result<u64, LogError> {
    let mut header = [0; 100];
    let mut file = fs::File::open(path).map_err(LogError::io(path))?;
    let not_a_bag = |_| LogError::new(path, LogFault::NotABag("it does not begin as SQLite".to_owned()));
    file.read_exact(&mut header).map_err(not_a_bag)?;
    if !header.starts_with(b"SQLite format 3\0") {
        return Err(LogError::new(path, LogFault::NotABag("it does not begin as SQLite".to_owned())));
    }
    let page = match u16::from_be_bytes([header[16], header[17]]) {
        1 => 65_536,
        page => u64::from(page),
    };
    let pages = u32::from_be_bytes([header[28], header[29], header[30], header[31]]);
    Ok((page * u64::from(pages)).saturating_sub(length))
}

fn open(path: &Path, length: u64, is_short: bool) -> rusqlite::Result<Connection> {
    let flags =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
    let mut wal = path.as_os_str().to_owned();
    wal.push("-wal");
    let has_wal = fs::metadata(wal).is_ok_and(|metadata| metadata.len() > 0);
    // A bag that nobody writes any more needs no locks, and those of a robot that was switched off cannot be undone.
    let suffix = if has_wal { "" } else { "?immutable=1" };
    let mut connection = Connection::open_with_flags(uri(path, suffix), flags)?;
    let most = i32::try_from(length.max(1 << 16)).unwrap_or(i32::MAX).min(1 << 30);
    connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, most)?;
    connection
        .execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0;")?;
    if is_short {
        // SQLite then reads what is there of a file that is shorter than it says.
        connection.execute_batch("PRAGMA writable_schema = ON;")?;
    }
    let left = AtomicU64::new(WORK.0.saturating_add(WORK.1.saturating_mul(length)) / STEP as u64);
    let is_spent =
        move || left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err();
    connection.progress_handler(STEP, Some(is_spent))?;
    Ok(connection)
}

/// Returns a path as SQLite's URIs have it.
fn uri(path: &Path, suffix: &str) -> String {
    let mut uri = String::from("file:");
    for byte in path.to_string_lossy().bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'.' | b'_' | b'-' => uri.push(byte as char),
            byte => uri.push_str(&format!("%{byte:02x}")),
        }
    }
    uri + suffix
}

/// Reads the topics that are wanted, with their definitions where the bag has them: since ROS 2 Iron.
fn wanted_topics(
    connection: &Connection,
    topics: &mut TopicSet,
    sink: &mut dyn Sink,
) -> rusqlite::Result<WantedTopics> {
    for table in ["topics", "messages"] {
        let is_table = "SELECT count(*) FROM sqlite_schema WHERE name = ?1 AND type = 'table'";
        let count: i64 = connection.query_row(is_table, [table], |row| row.get(0))?;
        if count != 1 {
            return Err(rusqlite::Error::InvalidColumnName(format!("it has no table `{table}`")));
        }
    }
    let mut wanted = HashMap::new();
    let mut statement = connection.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let (id, name, type_name): (i64, String, String) = (row.get(0)?, row.get(1)?, row.get(2)?);
        let message_encoding: String = row.get(3).unwrap_or_else(|_| "cdr".to_owned());
        let (schema_encoding, text) = definition(connection, &type_name).unwrap_or_default();
        let raw = RawDefinition {
            message_encoding: &message_encoding,
            schema_encoding: &schema_encoding,
            type_name: &type_name,
            data: text.as_bytes(),
        };
        let topic = topics.topic(&name, raw);
        if sink.wants(&topic) {
            wanted.insert(id, topic);
        }
    }
    Ok(wanted)
}

/// Returns encoding and text of a type's definition.
fn definition(connection: &Connection, type_name: &str) -> Option<(String, String)> {
    let query = "SELECT encoding, encoded_message_definition FROM message_definitions WHERE topic_type = ?1";
    connection.query_row(query, [type_name], |row| Ok((row.get(0)?, row.get(1)?))).ok()
}

struct Reader<'a> {
    wanted: WantedTopics,
    sink: &'a mut dyn Sink,
    length: u64,
    last_id: i64,
    bytes: u64,
}

impl Reader<'_> {
    /// Reads all messages; returns also whether some could not be.
    fn read(&mut self, connection: &Connection) -> rusqlite::Result<(ControlFlow<()>, bool)> {
        let contents = if self.sink.needs_contents() { "data" } else { "NULL" };
        let all = format!("SELECT id, topic_id, timestamp, {contents} FROM messages ORDER BY id");
        match self.rows(&mut connection.prepare(&all)?, None) {
            Ok(flow) => return Ok((flow, false)),
            Err(error) if !is_damage(&error) => return Err(error),
            Err(_) => {}
        }
        // Row by row: each is found by another way through the file.
        let one = format!("SELECT id, topic_id, timestamp, {contents} FROM messages WHERE id = ?1");
        let mut one = connection.prepare(&one)?;
        let (mut id, mut missing) = (self.last_id + 1, 0);
        while missing < MAX_MISSING_ROWS {
            match self.rows(&mut one, Some(id)) {
                Ok(ControlFlow::Break(())) => return Ok((ControlFlow::Break(()), true)),
                Ok(_) if self.last_id == id => missing = 0,
                Err(error) if !is_damage(&error) => break,
                _ => missing += 1,
            }
            id += 1;
        }
        Ok((ControlFlow::Continue(()), true))
    }

    fn rows(&mut self, statement: &mut Statement<'_>, id: Option<i64>) -> rusqlite::Result<ControlFlow<()>> {
        let mut rows = match id {
            Some(id) => statement.query([id])?,
            None => statement.query([])?,
        };
        while let Some(row) = rows.next()? {
            if self.row(row)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn row(&mut self, row: &Row<'_>) -> rusqlite::Result<ControlFlow<()>> {
        let (id, topic, log_time_ns): (i64, i64, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
        let Some(topic) = self.wanted.get(&topic) else {
            self.last_id = id;
            return Ok(ControlFlow::Continue(()));
        };
        let data = row.get_ref(3)?.as_blob_or_null().ok().flatten().unwrap_or_default();
        self.bytes += data.len() as u64;
        let log_time_ns = log_time_ns.clamp(-LATEST_NS, LATEST_NS);
        let flow = self.sink.take(Message { topic, log_time_ns, data: &unpacked_message(data) });
        self.sink.read_so_far(self.bytes.min(self.length));
        self.last_id = id;
        Ok(flow)
    }
}

/// Returns whether an error is a damaged place in the file, behind which there may be more.
fn is_damage(error: &rusqlite::Error) -> bool {
    use rusqlite::ErrorCode::{DatabaseCorrupt, NotADatabase, SystemIoFailure};
    match error {
        rusqlite::Error::SqliteFailure(failure, _) => {
            matches!(failure.code, DatabaseCorrupt | NotADatabase | SystemIoFailure)
        }
        rusqlite::Error::InvalidColumnType(..) => true,
        _ => false,
    }
}
