//! Quality of the poses by robot and day, and the worst recordings.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::{rows::StudyRow, statistics::median};

/// Number of recordings that are shown as the worst.
const WORST: usize = 10;

/// Quality of the poses of a robot's recordings of one day: medians over its recordings and their settings.
#[derive(Debug, Serialize)]
pub struct TaggingOnDay {
    pub robot: String,
    pub day: String,
    pub recordings: usize,
    pub lines_within_5px: Option<f64>,
    pub lines_within_10px: Option<f64>,
    /// Share of the pictures with a pose.
    pub completeness: Option<f64>,
    /// Mean error, of recordings with reference poses.
    pub mean_m: Option<f64>,
}

/// Recording whose poses are among the worst.
#[derive(Debug, Serialize)]
pub struct WorstRecording {
    pub name: String,
    pub robot: String,
    pub day: String,
    /// Hash of the recording.
    pub recording: String,
    /// Share of the lines that are met within 10 px, times the share of pictures with a pose.
    pub quality: f64,
    pub verdict: String,
    /// Number of the picture that agrees least.
    pub worst_frame: u64,
    /// That picture as a JPEG file, with the lines where its pose projects them.
    #[serde(skip)]
    pub picture: Option<Vec<u8>>,
}

/// Returns the quality by robot and day.
pub fn by_day(rows: &[StudyRow]) -> Vec<TaggingOnDay> {
    let mut groups: BTreeMap<(&str, &str), Vec<&StudyRow>> = BTreeMap::new();
    for row in tagged(rows) {
        groups.entry((&row.robot, &row.day)).or_default().push(row);
    }
    let summary = |((robot, day), rows): ((&str, &str), Vec<&StudyRow>)| {
        let median_of = |name| median(rows.iter().filter_map(|row| row.figure(name)));
        TaggingOnDay {
            robot: robot.to_owned(),
            day: day.to_owned(),
            recordings: rows.iter().map(|row| &row.recording).collect::<BTreeSet<_>>().len(),
            lines_within_5px: median_of("lines_within_5px"),
            lines_within_10px: median_of("lines_within_10px"),
            completeness: median_of("completeness"),
            mean_m: median_of("mean_m"),
        }
    };
    groups.into_iter().map(summary).collect()
}

/// Returns the recordings with the worst poses, each with the best of its settings, the worst first.
pub fn worst(rows: &[StudyRow]) -> Vec<WorstRecording> {
    let mut best: BTreeMap<&str, &StudyRow> = BTreeMap::new();
    for row in tagged(rows) {
        let known = best.entry(&row.recording).or_insert(row);
        if quality(row) > quality(known) {
            *known = row;
        }
    }
    let mut rows: Vec<&StudyRow> = best.into_values().collect();
    rows.sort_by(|a, b| quality(a).total_cmp(&quality(b)));
    let worst = |row: &&StudyRow| WorstRecording {
        name: row.name.clone(),
        robot: row.robot.clone(),
        day: row.day.clone(),
        recording: row.recording.clone(),
        quality: quality(row),
        verdict: row.report["verdict"].as_str().unwrap_or_default().to_owned(),
        worst_frame: row.report["worst_frame"].as_u64().unwrap_or_default(),
        picture: row.picture.clone(),
    };
    rows.iter().take(WORST).map(worst).collect()
}

/// Returns the rows that tell poses.
pub fn tagged(rows: &[StudyRow]) -> impl Iterator<Item = &StudyRow> {
    rows.iter().filter(|row| row.job == "tag" && row.error.is_none())
}

fn quality(row: &StudyRow) -> f64 {
    let share = |name| row.figure(name).unwrap_or_default();
    share("lines_within_10px") * share("completeness")
}
