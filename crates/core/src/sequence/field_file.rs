//! `field.toml`: the field's dimensions.

use std::path::Path;

use super::{
    error::{Fault, SequenceError},
    text::read_and_parse,
    toml_text::{line_of_key, parse},
};
use crate::field::FieldDimensions;

/// Reads and validates a field file.
pub fn read_field(path: &Path) -> Result<FieldDimensions, SequenceError> {
    read_and_parse(path, parse_field)
}

/// A field from the text of its file.
pub(super) fn parse_field(path: &Path, text: &str) -> Result<FieldDimensions, SequenceError> {
    let field: FieldDimensions = parse(path, text)?;
    field
        .validate()
        .map_err(|error| SequenceError::at(path, line_of_key(text, &[error.name]), Fault::Field(error)))?;
    Ok(field)
}
