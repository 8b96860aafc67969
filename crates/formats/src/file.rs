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

/// Reads all bytes of a regular file that is not larger than the limit.
pub(crate) fn read_bytes(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, ModelError> {
    let unreadable = |error: io::Error| ModelError::of_file(path, ModelFault::Unreadable(error));
    let mut file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(unreadable(io::Error::other("it is not a regular file")));
    }
    if metadata.len() > limit_bytes {
        return Err(ModelError::of_file(path, ModelFault::TooLarge { limit_bytes }));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(metadata.len()).unwrap_or(0));
    // The file may grow while it is read.
    file.by_ref().take(metadata.len()).read_to_end(&mut bytes).map_err(unreadable)?;
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
