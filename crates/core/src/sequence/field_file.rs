//! `field.toml`: dimensions of the field.

use std::path::Path;

use super::{
    error::{Fault, SequenceError, excerpt},
    limits::MAX_TOML_BYTES,
    printable::is_printable,
    text::read_and_parse,
    toml_text::{line_of_key, parse, print},
};
use crate::field::FieldDimensions;

/// Reads and validates a field file. Fails if it cannot be read, or with the first value that is missing or invalid.
pub fn read_field(path: &Path) -> Result<FieldDimensions, SequenceError> {
    read_and_parse(path, MAX_TOML_BYTES, FieldDimensions::from_toml)
}

impl FieldDimensions {
    /// Parses the text of a `field.toml`. Fails with the first value that is missing or invalid. Errors name `origin`:
    /// the file, or another source of the text.
    pub fn from_toml(origin: &Path, text: &str) -> Result<Self, SequenceError> {
        let field: Self = parse(origin, text)?;
        field.validate().map_err(|error| {
            SequenceError::at(origin, line_of_key(text, &[error.name]), Fault::Field(error))
        })?;
        if !is_printable(&field.name) {
            let fault = Fault::BadName { key: "name", name: excerpt(&field.name) };
            return Err(SequenceError::at(origin, line_of_key(text, &["name"]), fault));
        }
        Ok(field)
    }

    /// Returns the text of a `field.toml` with this field. Fails if the field cannot be written as TOML. Errors name
    /// `origin`: the file, or another destination of the text.
    pub fn to_toml(&self, origin: &Path) -> Result<String, SequenceError> {
        print(origin, self)
    }
}
