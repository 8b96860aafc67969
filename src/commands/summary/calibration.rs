//! Health of the calibration by robot and day: which effect, how large, since when.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use serde_json::Value;

use super::{rows::StudyRow, statistics::median};

/// Effect that the files of a robot's camera lack.
#[derive(Debug, Serialize)]
pub struct EffectOfRobot {
    pub robot: String,
    /// Name of the effect as in `model.toml`.
    pub id: String,
    pub name: String,
    /// Size in the latest recording that shows it, in words.
    pub size: String,
    /// First day of those up to the last showing day between which no day is without it.
    pub since: String,
    /// Whether it is there on the last day on which the robot was compared.
    pub is_there: bool,
    pub days: Vec<EffectOnDay>,
}

/// Effect on one day.
#[derive(Debug, Serialize)]
pub struct EffectOnDay {
    pub day: String,
    /// Number of comparisons: a recording that was compared with several settings counts for each.
    pub comparisons: usize,
    /// Number of them that show it.
    pub showing: usize,
    /// Medians of its parameters over these, in the units of `model.toml`.
    pub parameters: BTreeMap<String, f64>,
}

/// Robot whose camera was compared, and whether anything was wrong.
#[derive(Debug, Serialize)]
pub struct RobotHealth {
    pub robot: String,
    /// Number of comparisons: a recording that was compared with several settings counts for each.
    pub comparisons: usize,
    /// Number of them without a missing effect, as far as they can tell.
    pub healthy: usize,
    /// Number of them with residuals that no effect explains.
    pub unexplained: usize,
    /// Median gap with the model as it is, in units of the noise.
    pub gap_before: Option<f64>,
    /// Median gap with the effects that were found.
    pub gap_after: Option<f64>,
}

/// Returns the health of every robot, the worst first.
pub fn robots(rows: &[StudyRow]) -> Vec<RobotHealth> {
    let mut robots: BTreeMap<&str, Vec<&StudyRow>> = BTreeMap::new();
    for row in compared(rows) {
        robots.entry(&row.robot).or_default().push(row);
    }
    let health = |(robot, rows): (&str, Vec<&StudyRow>)| {
        let verdict = |row: &&&StudyRow| row.report["verdict"].as_str().unwrap_or_default().to_owned();
        let median_of = |name| median(rows.iter().filter_map(|row| row.figure(name)));
        RobotHealth {
            robot: robot.to_owned(),
            comparisons: rows.len(),
            healthy: rows.iter().filter(|row| verdict(row) == "none").count(),
            unexplained: rows.iter().filter(|row| verdict(row) == "unknown").count(),
            gap_before: median_of("gap_before"),
            gap_after: median_of("gap_after"),
        }
    };
    let mut robots: Vec<RobotHealth> = robots.into_iter().map(health).collect();
    let share = |robot: &RobotHealth| robot.healthy as f64 / robot.comparisons.max(1) as f64;
    robots.sort_by(|a, b| share(a).total_cmp(&share(b)));
    robots
}

/// Returns the effects of every robot: those that are still there first, and of them the oldest.
pub fn effects(rows: &[StudyRow]) -> Vec<EffectOfRobot> {
    let mut found: BTreeSet<(&str, &str)> = BTreeSet::new();
    for row in compared(rows) {
        found.extend(effects_of(row).filter_map(|effect| Some((row.robot.as_str(), effect["id"].as_str()?))));
    }
    let mut effects: Vec<EffectOfRobot> =
        found.into_iter().filter_map(|(robot, id)| EffectOfRobot::new(rows, robot, id)).collect();
    effects.sort_by(|a, b| b.is_there.cmp(&a.is_there).then_with(|| a.since.cmp(&b.since)));
    effects
}

impl EffectOfRobot {
    /// Follows an effect from day to day. A day shows it where more than half of its comparisons do.
    fn new(rows: &[StudyRow], robot: &str, id: &str) -> Option<Self> {
        let mut by_day: BTreeMap<&str, Vec<&StudyRow>> = BTreeMap::new();
        for row in compared(rows).filter(|row| row.robot == robot) {
            by_day.entry(&row.day).or_default().push(row);
        }
        let days: Vec<EffectOnDay> =
            by_day.iter().map(|(day, rows)| EffectOnDay::new(day, rows, id)).collect();
        let shows = |day: &EffectOnDay| 2 * day.showing > day.comparisons;
        let last = days.iter().rposition(shows)?;
        let first = days[..last].iter().rposition(|day| !shows(day)).map_or(0, |before| before + 1);
        let latest = by_day.values().flatten().rev().find_map(|row| effect_of(row, id))?;
        let word = |key: &str| latest[key].as_str().unwrap_or(id).to_owned();
        Some(Self {
            robot: robot.to_owned(),
            id: id.to_owned(),
            name: word("name"),
            size: word("size"),
            since: days[first].day.clone(),
            is_there: last + 1 == days.len(),
            days,
        })
    }
}

impl EffectOnDay {
    fn new(day: &str, rows: &[&StudyRow], id: &str) -> Self {
        let showing: Vec<&Value> = rows.iter().filter_map(|row| effect_of(row, id)).collect();
        let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for (name, estimate) in showing.iter().filter_map(|effect| effect["parameters"].as_object()).flatten()
        {
            values.entry(name.clone()).or_default().extend(estimate["value"].as_f64());
        }
        let medians = values.into_iter().filter_map(|(name, values)| Some((name, median(values)?)));
        Self {
            day: day.to_owned(),
            comparisons: rows.len(),
            showing: showing.len(),
            parameters: medians.collect(),
        }
    }
}

fn compared(rows: &[StudyRow]) -> impl Iterator<Item = &StudyRow> {
    rows.iter().filter(|row| row.job == "gap" && row.error.is_none())
}

fn effects_of(row: &StudyRow) -> impl Iterator<Item = &Value> {
    row.report["effects"].as_array().into_iter().flatten()
}

fn effect_of<'a>(row: &'a StudyRow, id: &str) -> Option<&'a Value> {
    effects_of(row).find(|effect| effect["id"] == id)
}
