//! MCAP files, read from front to back.

use std::{
    fs::File,
    io::{self, BufReader, Read},
    ops::ControlFlow,
    path::Path,
};

use mcap::{MAGIC, records::op};

use super::{
    error::{LogError, LogFault},
    mcap_chunk::read_chunk,
    mcap_receiver::Receiver,
    mcap_records::{RECORD_HEADER_BYTES, record_header},
    sink::{Ending, Outcome, Sink},
    topic::TopicSet,
};

/// Size of the buffer in front of the file, bytes.
const BUFFER_BYTES: usize = 1 << 20;

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
        self.receiver.read_so_far(self.position);
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
