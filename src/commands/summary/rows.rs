//! Rows of the tables that studies write.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, bail};
use serde_json::Value;

use reality_sim_formats::parquet_rows::{Cell, ParquetRow, read_parquet_rows};

/// Columns without which a table is none of a study.
const KEY: [&str; 3] = ["recording", "settings", "version"];

/// What a study says of one recording with some settings.
#[derive(Debug)]
pub struct StudyRow {
    /// Hash of the recording.
    pub recording: String,
    /// Hash of the settings.
    pub settings: String,
    pub version: String,
    /// Job that was done: `tag`, `gap`, `evaluate` or `dataset`.
    pub job: String,
    pub error: Option<String>,
    pub name: String,
    pub robot: String,
    /// Day of the recording; empty if it is not known.
    pub day: String,
    /// Everything that is no number.
    pub report: Value,
    /// JPEG file.
    pub picture: Option<Vec<u8>>,
    cells: ParquetRow,
}

impl StudyRow {
    /// Returns a number by the name of its column.
    pub fn figure(&self, name: &str) -> Option<f64> {
        match self.cells.get(name) {
            Some(Cell::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// Takes a row of a table.
    pub fn new(mut cells: ParquetRow) -> Self {
        let mut text = |name: &str| match cells.remove(name) {
            Some(Cell::Text(text)) => Some(text),
            _ => None,
        };
        let [recording, settings, version, job] =
            ["recording", "settings", "version", "job"].map(|name| text(name).unwrap_or_default());
        let report = text("report").and_then(|json| serde_json::from_str(&json).ok()).unwrap_or_default();
        let (error, day) = (text("error"), text("day").unwrap_or_default());
        let name = text("name").unwrap_or_else(|| format!("recording {}", recording.get(..8).unwrap_or("?")));
        let robot = text("robot").unwrap_or_else(|| "unknown robot".to_owned());
        let picture = match cells.remove("picture") {
            Some(Cell::Bytes(bytes)) => Some(bytes),
            _ => None,
        };
        Self { recording, settings, version, job, error, name, robot, day, report, picture, cells }
    }
}

/// Reads tables: Parquet files, and folders of them. Rows come in the order of recordings and settings, each once: that of the newest
/// version of the library.
pub fn read(tables: &[PathBuf]) -> anyhow::Result<Vec<StudyRow>> {
    let mut rows = Vec::new();
    for path in tables {
        for file in files(path)? {
            let cells = read_parquet_rows(&file)?;
            if let Some(row) = cells.first()
                && let Some(column) = KEY.iter().find(|column| !row.contains_key(**column))
            {
                bail!(
                    "{}: has no column {column}: give tables that `reality_sim.studies` has written",
                    file.display()
                );
            }
            rows.extend(cells.into_iter().map(StudyRow::new));
        }
    }
    if rows.is_empty() {
        bail!("{}: holds no rows: study some recordings first", tables[0].display());
    }
    Ok(newest(rows))
}

/// Returns the rows in the order of their keys, of each recording with the same settings only that of the newest version. Of two builds of one
/// version, which differ in what follows its `+`, that of the table named last counts.
pub fn newest(mut rows: Vec<StudyRow>) -> Vec<StudyRow> {
    let study = |row: &StudyRow| (row.recording.clone(), row.settings.clone());
    let version = |row: &StudyRow| -> Vec<u64> {
        let (numbers, _build) = row.version.split_once('+').unwrap_or((&row.version, ""));
        numbers.split(['.', '-']).map_while(|part| part.parse().ok()).collect()
    };
    // Sorting keeps the order of rows that are alike.
    rows.reverse();
    rows.sort_by_cached_key(|row| (study(row), std::cmp::Reverse(version(row))));
    rows.dedup_by_key(|row| study(row));
    rows
}

/// Returns the table's files, in the order of their names.
fn files(path: &Path) -> anyhow::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    let unreadable = || format!("{}: cannot be read", path.display());
    let entries = fs::read_dir(path).with_context(unreadable)?.collect::<Result<Vec<_>, _>>();
    let is_table = |file: &PathBuf| {
        let is_hidden = file.file_name().is_none_or(|name| name.as_encoded_bytes().starts_with(b"."));
        !is_hidden && file.extension().is_some_and(|ending| ending == "parquet")
    };
    let files = entries.with_context(unreadable)?.into_iter().map(|entry| entry.path()).filter(is_table);
    let mut files: Vec<PathBuf> = files.collect();
    files.sort();
    Ok(files)
}
