//! Everything that a summary says.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use reality_sim::sequence::counted;

use super::{
    calibration::{self, EffectOfRobot, RobotHealth},
    next::{self, FieldCoverage, NotSeen},
    rows::StudyRow,
    tagging::{self, TaggingOnDay, WorstRecording},
};

/// What many recordings say together.
#[derive(Debug, Serialize)]
pub struct Summary {
    pub recordings: usize,
    pub rows: usize,
    /// Versions of the library that made the rows.
    pub versions: Vec<String>,
    pub robots: Vec<RobotHealth>,
    pub effects: Vec<EffectOfRobot>,
    pub tagging: Vec<TaggingOnDay>,
    pub not_seen: Vec<NotSeen>,
    pub coverage: Vec<FieldCoverage>,
    pub worst: Vec<WorstRecording>,
    pub errors: Vec<FailedRow>,
}

/// Studies that failed for the same reason.
#[derive(Debug, Serialize)]
pub struct FailedRow {
    pub job: String,
    pub error: String,
    pub recordings: usize,
}

impl Summary {
    /// Finds what rows say.
    pub fn new(rows: &[StudyRow]) -> Self {
        Self {
            recordings: rows.iter().map(|row| &row.recording).collect::<BTreeSet<_>>().len(),
            rows: rows.len(),
            versions: rows
                .iter()
                .map(|row| row.version.clone())
                .collect::<BTreeSet<_>>()
                .into_iter()
                .collect(),
            robots: calibration::robots(rows),
            effects: calibration::effects(rows),
            tagging: tagging::by_day(rows),
            not_seen: next::not_seen(rows),
            coverage: next::coverage(rows),
            worst: tagging::worst(rows),
            errors: errors(rows),
        }
    }

    /// Says what matters most.
    pub fn sentence(&self) -> String {
        let there: Vec<&EffectOfRobot> = self.effects.iter().filter(|effect| effect.is_there).collect();
        let robots: BTreeSet<&str> = there.iter().map(|effect| effect.robot.as_str()).collect();
        let compared: usize = self.robots.iter().map(|robot| robot.comparisons).sum();
        match there.first() {
            Some(first) => {
                let since =
                    if first.since.is_empty() { String::new() } else { format!(" since {}", first.since) };
                format!(
                    "{} of {} need a calibration: {} has {}{since}.",
                    robots.len(),
                    counted(self.robots.len(), "robot"),
                    first.robot,
                    first.name
                )
            }
            None if compared > 0 => {
                format!(
                    "The calibration of {} is as the recordings show it.",
                    counted(self.robots.len(), "robot")
                )
            }
            None => format!("{} were studied.", counted(self.recordings, "recording")),
        }
    }

    /// Says everything, a line each.
    pub fn lines(&self) -> Vec<(&str, String)> {
        let mut lines = vec![(
            "read",
            format!("{} of {}", counted(self.rows, "row"), counted(self.recordings, "recording")),
        )];
        for effect in &self.effects {
            let state = if effect.is_there { "" } else { " (gone)" };
            lines.push((
                "effect",
                format!(
                    "{}: {}, {}, since {}{state}",
                    effect.robot,
                    effect.name,
                    effect.size,
                    or_unknown(&effect.since)
                ),
            ));
        }
        let percent = |share: Option<f64>| format!("{:.0} %", 100.0 * share.unwrap_or_default());
        for day in &self.tagging {
            let (robot, date) = (&day.robot, or_unknown(&day.day));
            let (poses, lines_met) = (percent(day.completeness), percent(day.lines_within_10px));
            lines.push((
                "poses",
                format!("{robot}, {date}: {poses} of the pictures, {lines_met} of the lines within 10 px"),
            ));
        }
        lines.extend(self.not_seen.iter().map(|one| ("record", one.record.clone())));
        lines.extend(self.worst.first().map(|worst| ("worst", format!("{}: {}", worst.name, worst.verdict))));
        lines
            .extend(self.errors.iter().map(|failed| ("failed", format!("{}: {}", failed.job, failed.error))));
        lines
    }
}

fn or_unknown(day: &str) -> &str {
    if day.is_empty() { "an unknown day" } else { day }
}

/// Counts the recordings by what is wrong with them.
fn errors(rows: &[StudyRow]) -> Vec<FailedRow> {
    let mut reasons: BTreeMap<(&str, &str), BTreeSet<&str>> = BTreeMap::new();
    for row in rows {
        if let Some(error) = &row.error {
            reasons.entry((&row.job, error)).or_default().insert(&row.recording);
        }
    }
    let failed = |((job, error), recordings): ((&str, &str), BTreeSet<&str>)| FailedRow {
        job: job.to_owned(),
        error: error.to_owned(),
        recordings: recordings.len(),
    };
    reasons.into_iter().map(failed).collect()
}
