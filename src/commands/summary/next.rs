//! What to record next: parts of the field of which there are few pictures, and effects that no recording can show.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use reality_sim::FieldDimensions;

use super::{rows::StudyRow, tagging::tagged};

/// Number of headings that studies tell apart.
const SECTORS: usize = 8;
/// Number of places that are named.
const NAMED: usize = 5;

/// Pictures of one field by place: cells of one square metre between its outer lines.
#[derive(Debug, Serialize)]
pub struct FieldCoverage {
    pub field: FieldDimensions,
    pub recordings: usize,
    /// Cells, row by row from the left end of the field.
    pub cells: Vec<CoveredCell>,
}

/// Pictures in a cell of the field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CoveredCell {
    /// Centre of the cell.
    pub x_m: f64,
    pub y_m: f64,
    pub pictures: u64,
    /// Number of headings, of eight, in which pictures were taken.
    pub headings: usize,
}

/// Effects that some recordings cannot show, and the recording that would.
#[derive(Debug, Serialize)]
pub struct NotSeen {
    /// What to record.
    pub record: String,
    /// Why the recordings do not show them.
    pub reason: String,
    pub effects: BTreeSet<String>,
    pub recordings: usize,
}

/// Returns the coverage of every field, that with the most recordings first.
pub fn coverage(rows: &[StudyRow]) -> Vec<FieldCoverage> {
    // Of a recording that was tagged with several settings, one counts.
    let once: BTreeMap<&str, &StudyRow> = tagged(rows).map(|row| (row.recording.as_str(), row)).collect();
    let mut fields: BTreeMap<String, Vec<&StudyRow>> = BTreeMap::new();
    for row in once.into_values() {
        fields.entry(row.report["field"].to_string()).or_default().push(row);
    }
    let mut fields: Vec<FieldCoverage> =
        fields.values().filter_map(|rows| FieldCoverage::new(rows)).collect();
    fields.sort_by_key(|field| std::cmp::Reverse(field.recordings));
    fields
}

impl FieldCoverage {
    fn new(rows: &[&StudyRow]) -> Option<Self> {
        let field: FieldDimensions = serde_json::from_value(rows.first()?.report["field"].clone()).ok()?;
        let mut found: BTreeMap<(i64, i64), (u64, BTreeSet<i64>)> = BTreeMap::new();
        for place in rows.iter().filter_map(|row| row.report["places"].as_array()).flatten() {
            let number = |key: &str| place[key].as_f64().unwrap_or(f64::NAN);
            let cell = found.entry((number("x_m").floor() as i64, number("y_m").floor() as i64)).or_default();
            cell.0 += place["pictures"].as_u64().unwrap_or_default();
            // Half a turn to either side is the same heading.
            let sector = (number("yaw_rad") / std::f64::consts::TAU * SECTORS as f64).round() as i64;
            cell.1.insert(sector.rem_euclid(SECTORS as i64));
        }
        let reach = |length_m: f64| (length_m / 2.0).ceil() as i64;
        let (x_end, y_end) = (reach(field.length_m), reach(field.width_m));
        let cell = |(x, y): (i64, i64)| {
            let (pictures, headings) =
                found.get(&(x, y)).map_or((0, 0), |(count, headings)| (*count, headings.len()));
            CoveredCell { x_m: x as f64 + 0.5, y_m: y as f64 + 0.5, pictures, headings }
        };
        let places = (-x_end..x_end).flat_map(|x| (-y_end..y_end).map(move |y| (x, y)));
        Some(Self { recordings: rows.len(), cells: places.map(cell).collect(), field })
    }

    /// Returns the cells with the fewest headings, and of them those with the fewest pictures.
    pub fn emptiest(&self) -> Vec<CoveredCell> {
        let mut cells = self.cells.clone();
        cells.sort_by_key(|cell| (cell.headings, cell.pictures));
        cells.truncate(NAMED);
        cells
    }
}

/// Returns what recordings do not show of their cameras, by what would show it, the most frequent first.
pub fn not_seen(rows: &[StudyRow]) -> Vec<NotSeen> {
    let mut remedies: BTreeMap<[&str; 2], (BTreeSet<String>, BTreeSet<&str>)> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.job == "gap" && row.error.is_none()) {
        for effect in row.report["unobservable"].as_array().into_iter().flatten() {
            let word = |key: &str| effect[key].as_str().unwrap_or_default();
            let (effects, recordings) =
                remedies.entry([word("recording_that_would_decide"), word("reason")]).or_default();
            effects.insert(word("id").to_owned());
            recordings.insert(&row.recording);
        }
    }
    let not_seen =
        |([record, reason], (effects, recordings)): ([&str; 2], (BTreeSet<String>, BTreeSet<&str>))| {
            NotSeen {
                record: record.to_owned(),
                reason: reason.to_owned(),
                effects,
                recordings: recordings.len(),
            }
        };
    let mut all: Vec<NotSeen> = remedies.into_iter().map(not_seen).collect();
    all.sort_by_key(|one| std::cmp::Reverse(one.recordings));
    all
}
