//! The summary as an HTML page, in the style of the gap's reports.

use std::fmt::Write;

use base64::{Engine, prelude::BASE64_STANDARD};
use reality_sim::{
    gap::html::{document, escape, table},
    sequence::counted,
};

use super::{
    calibration::{EffectOfRobot, RobotHealth},
    findings::{FailedRow, Summary},
    next::{CoveredCell, FieldCoverage, NotSeen},
    tagging::{TaggingOnDay, WorstRecording},
};

/// Edge of a cell of the map, pixels.
const CELL_PX: f64 = 40.0;

/// Returns the page, with its pictures embedded.
pub fn page(summary: &Summary) -> String {
    let sections = [
        head(summary),
        robots(&summary.robots),
        effects(&summary.effects),
        tagging(&summary.tagging),
        not_seen(&summary.not_seen),
        summary.coverage.iter().map(coverage).collect(),
        worst(&summary.worst),
        errors(summary),
    ];
    document("Summary of recordings", &sections.concat())
}

fn head(summary: &Summary) -> String {
    format!(
        "<h1>Summary of {}</h1>\n<p class=\"verdict\">{}</p>\n<p class=\"quiet\">{} of {}</p>\n",
        counted(summary.recordings, "recording"),
        escape(&summary.sentence()),
        counted(summary.rows, "row"),
        escape(&summary.versions.join(", ")),
    )
}

fn robots(robots: &[RobotHealth]) -> String {
    let row = |robot: &RobotHealth| {
        vec![
            escape(&robot.robot),
            robot.comparisons.to_string(),
            robot.healthy.to_string(),
            robot.unexplained.to_string(),
            number(robot.gap_before, 2),
            number(robot.gap_after, 2),
        ]
    };
    titled_table(
        "Calibration by robot",
        &[
            "Robot",
            ">Comparisons",
            ">Nothing missing",
            ">Unexplained",
            ">Gap before, noise",
            ">Gap after, noise",
        ],
        robots.iter().map(row),
    )
}

fn effects(effects: &[EffectOfRobot]) -> String {
    let days = |effect: &EffectOfRobot| -> String {
        let shown = effect.days.iter().map(|day| {
            let sizes: Vec<String> =
                day.parameters.iter().map(|(name, value)| format!("{} {value:.3e}", escape(name))).collect();
            let sizes = if sizes.is_empty() { String::new() } else { format!(": {}", sizes.join(", ")) };
            format!("{} {} of {}{sizes}", escape(day_name(&day.day)), day.showing, day.comparisons)
        });
        shown.collect::<Vec<_>>().join("<br/>")
    };
    let row = |effect: &EffectOfRobot| {
        let until = if effect.is_there { "until now" } else { "gone since" };
        vec![
            escape(&effect.robot),
            format!("{} <code>{}</code>", escape(&effect.name), escape(&effect.id)),
            escape(&effect.size),
            format!("{}, {until}", escape(day_name(&effect.since))),
            days(effect),
        ]
    };
    titled_table(
        "Effects that the files of the cameras lack",
        &["Robot", "Effect", "Size at last", "Since", "Comparisons that show it, by day"],
        effects.iter().map(row),
    )
}

fn tagging(days: &[TaggingOnDay]) -> String {
    let row = |day: &TaggingOnDay| {
        vec![
            escape(&day.robot),
            escape(day_name(&day.day)),
            day.recordings.to_string(),
            percent(day.completeness),
            percent(day.lines_within_5px),
            percent(day.lines_within_10px),
            number(day.mean_m.map(|metres| 100.0 * metres), 1),
        ]
    };
    titled_table(
        "Poses by robot and day",
        &[
            "Robot",
            "Day",
            ">Recordings",
            ">With a pose",
            ">Lines within 5 px",
            ">Lines within 10 px",
            ">Mean error, cm",
        ],
        days.iter().map(row),
    )
}

fn not_seen(not_seen: &[NotSeen]) -> String {
    let row = |one: &NotSeen| {
        let effects: Vec<String> =
            one.effects.iter().map(|id| format!("<code>{}</code>", escape(id))).collect();
        vec![escape(&one.record), effects.join(", "), one.recordings.to_string(), escape(&one.reason)]
    };
    titled_table(
        "What to record next, for the cameras",
        &["Record", "To see", ">Recordings without", "Why not there"],
        not_seen.iter().map(row),
    )
}

/// Draws the field from above: the darker a cell, the more headings were recorded there.
fn coverage(coverage: &FieldCoverage) -> String {
    let (left, top) = coverage
        .cells
        .iter()
        .fold((0.0_f64, 0.0_f64), |(left, top), cell| (left.min(cell.x_m - 0.5), top.max(cell.y_m + 0.5)));
    let (width, height) = (-2.0 * left * CELL_PX, 2.0 * top * CELL_PX);
    let mut svg = String::new();
    for CoveredCell { x_m, y_m, pictures, headings } in &coverage.cells {
        let (x, y) = ((x_m - 0.5 - left) * CELL_PX, (top - y_m - 0.5) * CELL_PX);
        // Writing into a string cannot fail.
        let _ = write!(
            svg,
            "<rect x=\"{x:.0}\" y=\"{y:.0}\" width=\"{CELL_PX}\" height=\"{CELL_PX}\" fill=\"var(--after)\" \
             fill-opacity=\"{:.3}\" class=\"frame\"><title>x {x_m} m, y {y_m} m: {}, {} of 8</title></rect>\
             <text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"middle\">{pictures}</text>",
            *headings as f64 / 8.0,
            counted(*pictures as usize, "picture"),
            counted(*headings, "heading"),
            x + CELL_PX / 2.0,
            y + CELL_PX / 2.0 + 4.0,
        );
    }
    let emptiest: Vec<String> = coverage
        .emptiest()
        .iter()
        .map(|cell| {
            let pictures = counted(cell.pictures as usize, "picture");
            format!("x {} m, y {} m ({pictures} in {} of 8 headings)", cell.x_m, cell.y_m, cell.headings)
        })
        .collect();
    format!(
        "<h2>What to record next, on the field of {} × {} m</h2>\n<p>Fewest headings at: {}.</p>\n<figure \
         class=\"maps\"><svg viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\">{svg}</svg><figcaption>Pictures with a \
         pose by square metre, of {}; the fuller the colour, the more headings. The opponent's goal is on the \
         right.</figcaption></figure>\n",
        coverage.field.length_m,
        coverage.field.width_m,
        emptiest.join(", "),
        counted(coverage.recordings, "recording"),
    )
}

fn worst(worst: &[WorstRecording]) -> String {
    if worst.is_empty() {
        return String::new();
    }
    let figure = |recording: &WorstRecording| {
        let picture = recording.picture.as_ref().map_or_else(String::new, |file| {
            let data = BASE64_STANDARD.encode(file);
            format!("<img alt=\"\" src=\"data:image/jpeg;base64,{data}\"/>")
        });
        let day = if recording.day.is_empty() { String::new() } else { format!(", {}", recording.day) };
        format!(
            "<figure>{picture}<figcaption><b>{}</b> ({}{}), picture {}: {}</figcaption></figure>\n",
            escape(&recording.name),
            escape(&recording.robot),
            escape(&day),
            recording.worst_frame,
            escape(&recording.verdict),
        )
    };
    format!(
        "<h2>The worst poses</h2>\n<p>Of each recording the picture that agrees least, with the field's lines where its pose \
         projects them.</p>\n<div class=\"three\">\n{}</div>\n",
        worst.iter().map(figure).collect::<String>()
    )
}

fn errors(summary: &Summary) -> String {
    let row =
        |error: &FailedRow| vec![escape(&error.job), escape(&error.error), error.recordings.to_string()];
    titled_table("Studies that failed", &["Job", "Reason", ">Recordings"], summary.errors.iter().map(row))
}

/// Returns a table under a title; nothing without rows. Titles and headings are plain text, cells are HTML.
fn titled_table(title: &str, headings: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let row = |cells: Vec<String>| {
        let cells = cells.iter().zip(headings).map(|(cell, heading)| {
            let class = if heading.starts_with('>') { " class=\"n\"" } else { "" };
            format!("<td{class}>{cell}</td>")
        });
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    let rows: Vec<String> = rows.map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    format!("<h2>{title}</h2>\n{}", table(headings, &rows))
}

fn day_name(day: &str) -> &str {
    if day.is_empty() { "day unknown" } else { day }
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.0}&#160;%", 100.0 * share))
}
