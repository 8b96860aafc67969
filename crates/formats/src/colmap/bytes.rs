//! Bytes of COLMAP's binary files, little-endian, read front to back.

use std::path::Path;

use crate::model_error::{ModelError, ModelFault};

/// Bytes of a file that have not been read yet.
pub(super) struct Bytes<'a> {
    path: &'a Path,
    all: &'a [u8],
    offset: usize,
}

impl<'a> Bytes<'a> {
    pub fn new(path: &'a Path, all: &'a [u8]) -> Self {
        Self { path, all, offset: 0 }
    }

    pub fn fail(&self, fault: ModelFault) -> ModelError {
        ModelError::of_file(self.path, fault)
    }

    fn rest(&self) -> &'a [u8] {
        &self.all[self.offset..]
    }

    /// Takes the next bytes of a fixed number.
    fn take<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], ModelError> {
        let Some((bytes, _)) = self.rest().split_first_chunk() else {
            return Err(self.fail(ModelFault::CutOff { what, offset: self.offset }));
        };
        self.offset += N;
        Ok(*bytes)
    }

    pub fn u32(&mut self, what: &'static str) -> Result<u32, ModelError> {
        self.take(what).map(u32::from_le_bytes)
    }

    pub fn i32(&mut self, what: &'static str) -> Result<i32, ModelError> {
        self.take(what).map(i32::from_le_bytes)
    }

    pub fn u64(&mut self, what: &'static str) -> Result<u64, ModelError> {
        self.take(what).map(u64::from_le_bytes)
    }

    pub fn f64(&mut self, what: &'static str) -> Result<f64, ModelError> {
        self.take(what).map(f64::from_le_bytes)
    }

    pub fn f64s<const N: usize>(&mut self, what: &'static str) -> Result<[f64; N], ModelError> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64(what)?;
        }
        Ok(values)
    }

    /// Reads how many records follow. Fails if so many, of this size at least, do not fit into the file.
    pub fn count(&mut self, what: &'static str, smallest_bytes: usize) -> Result<usize, ModelError> {
        let count = self.u64(what)?;
        let fits = self.rest().len() / smallest_bytes;
        usize::try_from(count)
            .ok()
            .filter(|count| *count <= fits)
            .ok_or_else(|| self.fail(ModelFault::Count { what, count }))
    }

    /// Skips bytes that [`Bytes::count`] has found to be there.
    pub fn skip(&mut self, bytes: usize) {
        self.offset = self.offset.saturating_add(bytes).min(self.all.len());
    }

    /// Reads text up to a zero byte.
    pub fn text(&mut self, what: &'static str) -> Result<String, ModelError> {
        let rest = self.rest();
        let Some(length) = rest.iter().position(|byte| *byte == 0) else {
            return Err(self.fail(ModelFault::CutOff { what, offset: self.offset }));
        };
        let text = std::str::from_utf8(&rest[..length]).map_err(|_| self.fail(ModelFault::NotUtf8))?;
        self.offset += length + 1;
        Ok(text.to_owned())
    }
}
