//! Logs and messages that are compressed as a whole.

use std::{
    borrow::Cow,
    fs::File,
    io::{self, BufReader, Read},
    path::Path,
};

use tempfile::NamedTempFile;

use super::error::{LogError, LogFault};

/// First bytes of what zstd has compressed.
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Times by which a file may grow when it is unpacked. Logs of raw pictures shrink to a tenth.
const MAX_GROWTH: u64 = 200;

/// Largest message that is unpacked, bytes.
pub(super) const MAX_MESSAGE_BYTES: u64 = 256 << 20;

/// Unpacks a file into a temporary one.
pub(super) fn unpack(path: &Path) -> Result<NamedTempFile, LogError> {
    let file = File::open(path).map_err(LogError::io(path))?;
    let limit = file.metadata().map_err(LogError::io(path))?.len().saturating_mul(MAX_GROWTH);
    let copy = || {
        let mut copy = NamedTempFile::new()?;
        let mut unpacked = zstd::stream::read::Decoder::with_buffer(BufReader::new(file))?.take(limit);
        match io::copy(&mut unpacked, &mut copy) {
            // What comes before a cut is kept: the log in it is salvaged as any other.
            Err(error) if copy.as_file().metadata()?.len() == 0 => Err(error),
            _ => Ok(copy),
        }
    };
    copy().map_err(|error| LogError::new(path, LogFault::Packed(error)))
}

/// Returns a message as it was sent: rosbag2 can compress each by itself. No encoding of messages begins as zstd does.
pub(super) fn unpacked_message(data: &[u8]) -> Cow<'_, [u8]> {
    if !data.starts_with(&ZSTD_MAGIC) {
        return Cow::Borrowed(data);
    }
    let mut unpacked = Vec::new();
    let limit = MAX_MESSAGE_BYTES.min((data.len() as u64).saturating_mul(MAX_GROWTH));
    let decoder = zstd::stream::read::Decoder::with_buffer(data);
    match decoder.and_then(|decoder| decoder.take(limit).read_to_end(&mut unpacked)) {
        Ok(_) => Cow::Owned(unpacked),
        Err(_) => Cow::Borrowed(data),
    }
}
