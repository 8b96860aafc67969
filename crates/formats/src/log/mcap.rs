//! MCAP files, read from front to back.

use std::{
    fs::File,
    io::{self, BufReader, Read},
    ops::ControlFlow,
    path::Path,
};

use mcap::{MAGIC, records::op};

use super::{
    Ending, Message, Sink,
    compressed::unpacked_message,
    error::{LogError, LogFault},
    mcap_chunk::read_chunk,
    mcap_records::{Channels, RECORD_HEADER_BYTES, message, record_header},
    topic::TopicSet,
};

/// Size of the buffer in front of the file, bytes.
const BUFFER_BYTES: usize = 1 << 20;

/// How reading a file or a chunk ended.
pub(super) type Outcome = (ControlFlow<()>, Ending);

/// Reads a file's messages up to the last whole one.
pub(super) fn read_mcap(
    path: &Path,
    topics: &mut TopicSet,
    sink: &mut dyn Sink,
) -> Result<Outcome, LogError> {
    let file = File::open(path).map_err(LogError::io(path))?;
    let length = file.metadata().map_err(LogError::io(path))?.len();
    let file = BufReader::with_capacity(BUFFER_BYTES, file);
    let mut scan = Scan { file, position: 0, length, receiver: Receiver::new(topics, sink) };
    let mut magic = [0; 8];
    match scan.file.read_exact(&mut magic) {
        Ok(()) if magic == *MAGIC => scan.position = MAGIC.len() as u64,
        Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(LogError::io(path)(error)),
        _ => return Err(LogError::new(path, LogFault::NotMcap)),
    }
    scan.run().map_err(LogError::io(path))
}

/// Place in a file, and who gets its messages.
struct Scan<'a> {
    file: BufReader<File>,
    position: u64,
    length: u64,
    receiver: Receiver<'a>,
}

/// Schemas and channels so far, and who gets the messages.
pub(super) struct Receiver<'a> {
    channels: Channels,
    topics: &'a mut TopicSet,
    sink: &'a mut dyn Sink,
    body: Vec<u8>,
}

impl Scan<'_> {
    fn run(&mut self) -> io::Result<Outcome> {
        let mut ending = Ending::default();
        loop {
            let left = self.length.saturating_sub(self.position);
            let cut = Ending { is_cut: true, bytes_lost: ending.bytes_lost.saturating_add(left) };
            if left < RECORD_HEADER_BYTES as u64 {
                return Ok((ControlFlow::Continue(()), cut));
            }
            let mut header = [0; RECORD_HEADER_BYTES];
            self.file.read_exact(&mut header)?;
            let (kind, length) = record_header(header);
            let rest = left - RECORD_HEADER_BYTES as u64;
            self.position += RECORD_HEADER_BYTES as u64;
            if kind == op::CHUNK {
                let (flow, of_chunk) = read_chunk(&mut self.file, length, rest, &mut self.receiver)?;
                ending = ending.joined(of_chunk);
                if flow.is_break() || length > rest {
                    return Ok((flow, ending));
                }
                self.advance(length, true)?;
                continue;
            }
            // A disk that lost power leaves zeros behind.
            if length > rest || kind == 0 {
                return Ok((ControlFlow::Continue(()), cut));
            }
            match kind {
                op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                    let flow = self.receiver.record(kind, length, &mut self.file)?;
                    self.advance(length, true)?;
                    if flow.is_break() {
                        return Ok((flow, ending));
                    }
                }
                op::DATA_END => {
                    ending.is_cut |= !self.ends_well()?;
                    return Ok((ControlFlow::Continue(()), ending));
                }
                _ => self.advance(length, false)?,
            }
        }
    }

    /// Goes to the end of a record.
    fn advance(&mut self, length: u64, is_read: bool) -> io::Result<()> {
        if !is_read {
            self.file.seek_relative(i64::try_from(length).unwrap_or(i64::MAX))?;
        }
        self.position += length;
        self.receiver.sink.read_so_far(self.position);
        Ok(())
    }

    /// Returns whether the file ends as MCAP files do.
    fn ends_well(&mut self) -> io::Result<bool> {
        use std::io::{Seek, SeekFrom};
        let mut magic = [0; 8];
        self.file.seek(SeekFrom::End(-(MAGIC.len() as i64)))?;
        self.file.read_exact(&mut magic)?;
        Ok(magic == *MAGIC)
    }
}

impl<'a> Receiver<'a> {
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

    fn message(&mut self) -> ControlFlow<()> {
        let Some((channel, log_time_ns, data)) = message(&self.body) else {
            return ControlFlow::Continue(());
        };
        match self.channels.by_id.get(&channel) {
            Some(channel) if channel.is_wanted => {
                let data = &unpacked_message(data);
                let log_time_ns = i64::try_from(log_time_ns).unwrap_or(i64::MAX);
                self.sink.take(Message { topic: &channel.topic, log_time_ns, data })
            }
            _ => ControlFlow::Continue(()),
        }
    }
}
