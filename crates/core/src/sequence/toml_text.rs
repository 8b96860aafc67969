//! Parsing and printing of TOML, with errors that name a line.

use std::path::Path;

use serde::{Serialize, de::DeserializeOwned};
use toml::de::{DeTable, DeValue};

use super::{
    error::{Fault, SequenceError},
    format_error::FormatError,
    printable::one_line,
    text::line_of_offset,
};

/// Parses values from a TOML text. Ignores keys that `T` does not have: they belong to other programs.
pub(super) fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, SequenceError> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map(|span| line_of_offset(text.as_bytes(), span.start));
        let message = one_line(error.message());
        match message.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`')) {
            // The line is that of the table's header, which the top-level table does not have.
            Some(key) => {
                let line = line.filter(|_| error.span().is_some_and(|span| span.start > 0));
                SequenceError::at(path, line, Fault::MissingKey { key: key.to_owned() })
            }
            None => SequenceError::at(path, line, Fault::Toml(FormatError::with_message(message, error))),
        }
    })
}

/// Prints values as TOML text.
pub(super) fn print<T: Serialize>(path: &Path, values: &T) -> Result<String, SequenceError> {
    toml::to_string(values)
        .map_err(|error| SequenceError::of_file(path, Fault::Toml(FormatError::new(error))))
}

/// Returns the line, from 1, of a value given by its keys: `["mount", "height_m"]`.
pub(super) fn line_of_key(text: &str, keys: &[&str]) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let (first, rest) = keys.split_first()?;
    let mut value = document.get_ref().get(*first)?;
    for key in rest {
        let DeValue::Table(table) = value.get_ref() else { return None };
        value = table.get(*key)?;
    }
    Some(line_of_offset(text.as_bytes(), value.span().start))
}

/// Checks numbers of a table, and names a value that breaks its rule with its line.
pub(super) struct NumberCheck<'a> {
    /// Path of the file.
    pub path: &'a Path,
    /// Whole text of the file.
    pub text: &'a str,
    /// Table that contains the keys, as in its header: `mount.correction`; empty for the top-level table.
    pub table: &'a str,
}

impl NumberCheck<'_> {
    /// Rejects a value that is not finite or breaks the rule.
    pub(super) fn check(
        &self,
        key: &'static str,
        value: f64,
        valid: impl Fn(f64) -> bool,
        rule: &'static str,
    ) -> Result<(), SequenceError> {
        if value.is_finite() && valid(value) {
            return Ok(());
        }
        let keys: Vec<&str> = self.table.split('.').chain([key]).filter(|key| !key.is_empty()).collect();
        let line = line_of_key(self.text, &keys);
        Err(SequenceError::at(self.path, line, Fault::BadValue { key, value, rule }))
    }
}
