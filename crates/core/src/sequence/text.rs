//! Reading of bytes and text from files, within limits.

use std::{
    fs::{self, File},
    io::{self, Read},
    path::Path,
};

use super::error::{Fault, SequenceError};

/// Reads all bytes of a regular file that is not larger than the limit.
pub(super) fn read_bytes(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, SequenceError> {
    let fail = |error: io::Error| SequenceError::of_file(path, read_fault(error));
    let metadata = fs::metadata(path).map_err(fail)?;
    if !metadata.is_file() {
        return Err(SequenceError::of_file(path, Fault::NotAFile));
    }
    let mut bytes = Vec::new();
    // The file may grow while it is read.
    File::open(path)
        .map_err(fail)?
        .take(limit_bytes.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(fail)?;
    if bytes.len() as u64 > limit_bytes {
        return Err(SequenceError::of_file(path, Fault::TooLarge { limit_bytes }));
    }
    Ok(bytes)
}

/// Reads a text file that is not larger than the limit, and hands it to a parser.
pub(super) fn read_and_parse<T>(
    path: &Path,
    limit_bytes: u64,
    parse: impl FnOnce(&Path, &str) -> Result<T, SequenceError>,
) -> Result<T, SequenceError> {
    let bytes = read_bytes(path, limit_bytes)?;
    parse(path, decode(path, &bytes)?)
}

/// Decodes the text of a file, without the byte order mark that some editors put in front.
pub(super) fn decode<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, SequenceError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = line_of_offset(bytes, error.valid_up_to());
        SequenceError::at(path, line, Fault::NotUtf8)
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Returns the line, from 1, that contains a byte.
pub(super) fn line_of_offset(bytes: &[u8], offset: usize) -> usize {
    1 + bytes.iter().take(offset).filter(|&&byte| byte == b'\n').count()
}

fn read_fault(error: io::Error) -> Fault {
    if error.kind() == io::ErrorKind::NotFound { Fault::Missing } else { Fault::Unreadable(error) }
}
