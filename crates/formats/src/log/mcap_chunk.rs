//! Chunks of MCAP: records that are compressed together.

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Read, Seek, Take},
    ops::ControlFlow,
};

use super::{
    compressed::MAX_MESSAGE_BYTES,
    mcap_receiver::Receiver,
    mcap_records::{RECORD_HEADER_BYTES, record_header},
    sink::{Ending, Outcome},
};

/// Longest name of a compression.
const MAX_NAME_BYTES: u32 = 64;

/// Size of the buffer behind a decompressor, bytes.
const BUFFER_BYTES: usize = 64 << 10;

/// What a chunk says of itself.
struct ChunkHeader {
    uncompressed_bytes: u64,
    compression: Compression,
    compressed_bytes: u64,
    /// Length of the header itself.
    length: u64,
}

enum Compression {
    None,
    Lz4,
    Zstd,
    Unknown,
}

/// Reads the messages of a chunk, of which the file holds `rest` bytes, and leaves the file at its end. A chunk that is cut
/// off or damaged gives the messages before the fault.
pub(super) fn read_chunk(
    file: &mut BufReader<File>,
    length: u64,
    rest: u64,
    receiver: &mut Receiver<'_>,
) -> io::Result<Outcome> {
    let there = length.min(rest);
    let end = file.stream_position()? + there;
    let is_cut = length > rest;
    let nothing = (ControlFlow::Continue(()), Ending { is_cut: true, bytes_lost: there });
    let outcome = match ChunkHeader::read(&mut file.by_ref().take(there)) {
        Some(header) if header.length <= there => {
            let there = header.compressed_bytes.min(there - header.length);
            let (flow, tally) = header.records(file.by_ref().take(there), receiver);
            let bytes_lost = if tally.is_whole && !is_cut { 0 } else { tally.lost_of(there) };
            (flow, Ending { is_cut: is_cut || !tally.is_whole, bytes_lost })
        }
        _ => nothing,
    };
    let from = file.stream_position()?;
    file.seek_relative(offset(end, from))?;
    Ok(outcome)
}

fn offset(to: u64, from: u64) -> i64 {
    (to as i64).wrapping_sub(from as i64)
}

/// Bytes of a chunk, unpacked.
struct Tally {
    /// Whether the chunk was read to its end.
    is_whole: bool,
    unpacked: u64,
    /// Those that lie before the end of the last whole record.
    used: u64,
}

impl Tally {
    /// Estimates how many of the packed bytes were read in vain, at least one.
    fn lost_of(&self, packed: u64) -> u64 {
        let used = if self.unpacked == 0 { 0.0 } else { self.used as f64 / self.unpacked as f64 };
        (((1.0 - used) * packed as f64).round() as u64).max(1)
    }
}

impl ChunkHeader {
    fn read(file: &mut impl Read) -> Option<Self> {
        let mut fixed = [0; 32];
        file.read_exact(&mut fixed).ok()?;
        let [.., a, b, c, d] = fixed;
        let name_length = u32::from_le_bytes([a, b, c, d]);
        let uncompressed_bytes = u64::from_le_bytes(fixed[16..24].try_into().ok()?);
        if name_length > MAX_NAME_BYTES {
            return None;
        }
        let mut name = Vec::new();
        file.take(u64::from(name_length)).read_to_end(&mut name).ok()?;
        let compression = match name.as_slice() {
            b"" => Compression::None,
            b"lz4" => Compression::Lz4,
            b"zstd" => Compression::Zstd,
            _ => Compression::Unknown,
        };
        let mut compressed = [0; 8];
        file.read_exact(&mut compressed).ok()?;
        let compressed_bytes = u64::from_le_bytes(compressed);
        let length = 32 + u64::from(name_length) + 8;
        Some(Self { uncompressed_bytes, compression, compressed_bytes, length })
    }

    /// Unpacks the records and hands them over.
    fn records(
        &self,
        packed: Take<&mut BufReader<File>>,
        receiver: &mut Receiver<'_>,
    ) -> (ControlFlow<()>, Tally) {
        let unreadable = (ControlFlow::Continue(()), Tally { is_whole: false, unpacked: 0, used: 0 });
        match self.compression {
            Compression::None => read_records(packed, self.uncompressed_bytes, receiver),
            Compression::Lz4 => match lz4::Decoder::new(packed) {
                Ok(unpacked) => self.buffered(unpacked, receiver),
                Err(_) => unreadable,
            },
            Compression::Zstd => match zstd::stream::read::Decoder::with_buffer(packed) {
                Ok(unpacked) => self.buffered(unpacked, receiver),
                Err(_) => unreadable,
            },
            Compression::Unknown => unreadable,
        }
    }

    fn buffered(&self, unpacked: impl Read, receiver: &mut Receiver<'_>) -> (ControlFlow<()>, Tally) {
        read_records(BufReader::with_capacity(BUFFER_BYTES, unpacked), self.uncompressed_bytes, receiver)
    }
}

/// Reads records up to the end of their source, or to the first that is not whole.
fn read_records(source: impl BufRead, length: u64, receiver: &mut Receiver<'_>) -> (ControlFlow<()>, Tally) {
    let mut source = Counted { inner: source.take(length), count: 0 };
    let mut used = 0;
    loop {
        let mut header = [0; RECORD_HEADER_BYTES];
        if source.count == length {
            return (ControlFlow::Continue(()), Tally { is_whole: true, unpacked: length, used: length });
        }
        let record = source.read_exact(&mut header).and_then(|()| {
            let (kind, length) = record_header(header);
            if length > MAX_MESSAGE_BYTES {
                return Err(io::ErrorKind::InvalidData.into());
            }
            receiver.record(kind, length, &mut source)
        });
        match record {
            Ok(ControlFlow::Continue(())) => used = source.count,
            Ok(flow) => return (flow, Tally { is_whole: true, unpacked: length, used: length }),
            Err(_) => {
                let unpacked = source.count.max(used);
                return (ControlFlow::Continue(()), Tally { is_whole: false, unpacked, used });
            }
        }
    }
}

/// Source that counts what was read from it.
struct Counted<R> {
    inner: R,
    count: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.count += count as u64;
        Ok(count)
    }
}
