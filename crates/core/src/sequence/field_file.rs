//! `field.toml`: the field's dimensions.

use std::path::Path;

use super::{
    error::{Fault, SequenceError},
    text::read_and_parse,
    toml_text::{line_of_key, parse, print},
};
use crate::field::FieldDimensions;

/// Reads and validates a field file.
pub fn read_field(path: &Path) -> Result<FieldDimensions, SequenceError> {
    read_and_parse(path, FieldDimensions::from_toml)
}

impl FieldDimensions {
    /// A field from the text of a `field.toml`. Errors name `origin`: the file, or what else the text comes from.
    pub fn from_toml(origin: &Path, text: &str) -> Result<Self, SequenceError> {
        let field: Self = parse(origin, text)?;
        field.validate().map_err(|error| {
            SequenceError::at(origin, line_of_key(text, &[error.name]), Fault::Field(error))
        })?;
        Ok(field)
    }

    /// The text of a `field.toml` with this field. Errors name `origin`: the file, or what else the text is for.
    pub fn to_toml(&self, origin: &Path) -> Result<String, SequenceError> {
        print(origin, self)
    }
}
