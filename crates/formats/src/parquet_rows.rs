//! Rows of Parquet tables of any columns.

use std::{collections::BTreeMap, fs::File, path::Path};

use parquet::{
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};
use reality_sim_core::sequence::one_line;

use crate::{
    file::{MAX_TABLE_BYTES, open_file},
    model_error::ModelError,
};

/// Value of a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// Number, of whatever size.
    Number(f64),
    /// Bytes.
    Bytes(Vec<u8>),
}

/// Values of a row by their columns' names; those that are null, or of another kind than a [`Cell`], are left out.
pub type ParquetRow = BTreeMap<String, Cell>;

/// Reads all rows of a Parquet file of at most 64 MiB, uncompressed or compressed with Snappy. Fails if the file cannot be read, or is none.
pub fn read_parquet_rows(path: &Path) -> Result<Vec<ParquetRow>, ModelError> {
    let file = open_file(path, MAX_TABLE_BYTES)?;
    rows(file).map_err(|error| {
        let words = one_line(&error);
        ModelError::of_table(
            path,
            format!("is not a Parquet table that can be read ({words}): write it again"),
        )
    })
}

fn rows(file: File) -> Result<Vec<ParquetRow>, ParquetError> {
    let reader = SerializedFileReader::new(file)?;
    let rows = reader.get_row_iter(None)?;
    rows.map(|row| {
        let row = row?;
        let cells = row.get_column_iter();
        Ok(cells.filter_map(|(name, field)| Some((name.clone(), cell(field)?))).collect())
    })
    .collect()
}

fn cell(field: &Field) -> Option<Cell> {
    Some(match field {
        Field::Str(text) => Cell::Text(text.clone()),
        Field::Bytes(bytes) => Cell::Bytes(bytes.data().to_vec()),
        Field::Double(number) => Cell::Number(*number),
        Field::Float(number) => Cell::Number(f64::from(*number)),
        Field::Int(number) => Cell::Number(f64::from(*number)),
        Field::Long(number) => Cell::Number(*number as f64),
        _ => return None,
    })
}
