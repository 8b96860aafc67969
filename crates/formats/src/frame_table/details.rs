//! Reading the table that `tag --details` writes.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use reality_sim_core::sequence::one_line;

use super::{
    table::{Column, FrameTable},
    values::Values,
};
use crate::{
    file::{MAX_TABLE_BYTES, read_text},
    model_error::{ModelError, ModelFault, excerpt},
};

impl FrameTable {
    /// Reads a table from a CSV file, as `tag --details` writes it. Columns that are not known are kept behind the others. Fails
    /// with the first value that is not of its column's kind, or if there is no column `timestamp_s`.
    pub fn read_details(path: &Path) -> Result<Self, ModelError> {
        Self::parse_details(path, &read_text(path, MAX_TABLE_BYTES)?)
    }

    /// Parses a table from the text of a CSV file; `path` is its name in errors.
    pub fn parse_details(path: &Path, text: &str) -> Result<Self, ModelError> {
        let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(text.as_bytes());
        let syntax = |error: csv::Error| {
            let line = error.position().map_or(1, csv::Position::line) as usize;
            ModelError::at(path, line, ModelFault::Syntax { message: one_line(&error) })
        };
        let header = reader.headers().map_err(syntax)?.clone();
        if !header.iter().any(|name| name == "timestamp_s") {
            return Err(ModelError::of_table(
                path,
                "has no column `timestamp_s`: give a file of `tag --details`",
            ));
        }
        let records: Vec<StringRecord> = reader.records().collect::<Result<_, _>>().map_err(syntax)?;
        let mut table = Self::empty(records.len());
        for (place, name) in header.iter().enumerate() {
            if table.column(name).is_none() {
                let values = unknown_values(&records, place);
                table.columns.push(Column { name: name.to_owned(), values });
                continue;
            }
            for (row, record) in records.iter().enumerate() {
                let field = record.get(place).unwrap_or_default();
                let line = record.position().map_or(row + 2, |position| position.line() as usize);
                let set = table.column_mut(name).is_none_or(|values| values.set(row, field));
                if !set {
                    let (key, value) = (name.to_owned(), excerpt(field));
                    let rule = "a value of the column's kind, or empty";
                    return Err(ModelError::at(path, line, ModelFault::BadValue { key, value, rule }));
                }
            }
        }
        Ok(table)
    }
}

impl Values {
    /// Sets a value from the text of a field; an empty one stays null. Returns whether the text is of the column's kind.
    fn set(&mut self, row: usize, field: &str) -> bool {
        if field.is_empty() {
            return true;
        }
        match self {
            Self::Numbers(values) => {
                let number: Option<f64> = field.parse().ok();
                // What is not finite is unknown.
                values[row] = number.filter(|number| number.is_finite());
                number.is_some()
            }
            Self::Counts(values) => {
                values[row] = field.parse().ok();
                values[row].is_some()
            }
            Self::Flags(values) => {
                values[row] = field.parse().ok();
                values[row].is_some()
            }
            Self::Texts(values) => {
                values[row] = Some(field.to_owned());
                true
            }
        }
    }
}

/// Returns a column that is not known: of numbers, if all its values are.
fn unknown_values(records: &[StringRecord], place: usize) -> Values {
    let fields = || records.iter().map(|record| record.get(place).unwrap_or_default());
    let is_number = |field: &str| field.is_empty() || field.parse::<f64>().is_ok();
    if fields().all(is_number) {
        Values::Numbers(fields().map(|field| field.parse().ok()).collect())
    } else {
        Values::Texts(fields().map(|field| Some(field.to_owned()).filter(|text| !text.is_empty())).collect())
    }
}
