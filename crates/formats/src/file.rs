//! Reading of whole files within limits.

use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

pub(crate) use reality_sim_core::sequence::is_inside_folder;

use crate::model_error::{ModelError, ModelFault};

/// Maximum size of a model's file, bytes: a hundred thousand pictures with a thousand points each take 2.4 GB in COLMAP's
/// binary form, and no recording of a robot comes near.
pub(crate) const MAX_MODEL_BYTES: u64 = 1 << 30;

/// Maximum size of a JSON file or a table, bytes: a hundred thousand pictures take some 40 MB. What is parsed takes up to ten times
/// as much memory.
pub(crate) const MAX_TABLE_BYTES: u64 = 64 << 20;

/// Maximum size of a picture file, bytes.
pub(crate) const MAX_PICTURE_BYTES: u64 = 512 << 20;

/// Opens a regular file that is not larger than the limit.
pub(crate) fn open_file(path: &Path, limit_bytes: u64) -> Result<File, ModelError> {
    let unreadable = |error: io::Error| ModelError::of_file(path, ModelFault::Unreadable(error));
    let file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(unreadable(io::Error::other("it is not a regular file")));
    }
    if metadata.len() > limit_bytes {
        return Err(ModelError::of_file(path, ModelFault::TooLarge { limit_bytes }));
    }
    Ok(file)
}

/// Reads all bytes of a regular file that is not larger than the limit.
pub(crate) fn read_bytes(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, ModelError> {
    let mut bytes = Vec::new();
    // The file may grow while it is read.
    let file = open_file(path, limit_bytes)?;
    let read = file.take(limit_bytes).read_to_end(&mut bytes);
    read.map_err(|error| ModelError::of_file(path, ModelFault::Unreadable(error)))?;
    Ok(bytes)
}

/// Reads a text file that is not larger than the limit, without the byte order mark that some editors put in front.
pub(crate) fn read_text(path: &Path, limit_bytes: u64) -> Result<String, ModelError> {
    let bytes = read_bytes(path, limit_bytes)?;
    let text = String::from_utf8(bytes).map_err(|_| ModelError::of_file(path, ModelFault::NotUtf8))?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}
