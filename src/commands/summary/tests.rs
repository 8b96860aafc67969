//! Summaries of rows that are made up: what a team must be told of them is known.

use reality_sim_formats::parquet_rows::{Cell, ParquetRow};
use serde_json::{Value, json};

use super::{
    findings::Summary,
    rows::{StudyRow, newest},
};

/// Makes a row. Numbers of the report are what a study writes.
fn row(job: &str, recording: &str, robot: &str, day: &str, report: &Value) -> StudyRow {
    let texts = [
        ("recording", recording),
        ("settings", "00"),
        ("version", "0.9.0"),
        ("job", job),
        ("name", recording),
        ("robot", robot),
        ("day", day),
    ];
    let mut cells: ParquetRow =
        texts.map(|(name, text)| (name.to_owned(), Cell::Text(text.to_owned()))).into_iter().collect();
    cells.insert("report".to_owned(), Cell::Text(report.to_string()));
    StudyRow::new(cells)
}

/// Makes a row of `gap`, which finds a mount that is pitched by some degrees, or nothing.
fn compared(recording: &str, robot: &str, day: &str, pitch_deg: Option<f64>) -> StudyRow {
    let effects: Vec<Value> = pitch_deg
        .iter()
        .map(|pitch| {
            json!({"id": "mount_pitch", "name": "pitch of the mount", "size": format!("{pitch}°"),
                   "parameters": {"pitch_rad": {"value": pitch.to_radians()}}})
        })
        .collect();
    let verdict = if effects.is_empty() { "none" } else { "named" };
    row("gap", recording, robot, day, &json!({"verdict": verdict, "effects": effects}))
}

#[test]
fn an_effect_is_there_since_the_first_day_after_the_last_one_without_it() {
    let rows = [
        compared("a", "23", "2026-05-01", Some(1.0)),
        compared("b", "23", "2026-05-02", None),
        compared("c", "23", "2026-05-03", Some(2.0)),
        // Most of a day's recordings decide, and their median is its size.
        compared("d", "23", "2026-05-04", Some(2.0)),
        compared("e", "23", "2026-05-04", Some(3.0)),
        compared("f", "23", "2026-05-04", None),
        compared("g", "24", "2026-05-01", Some(1.0)),
        compared("h", "24", "2026-05-04", None),
        compared("i", "25", "2026-05-04", None),
    ];
    let summary = Summary::new(&rows);
    let found: Vec<_> =
        summary.effects.iter().map(|one| (one.robot.as_str(), one.since.as_str(), one.is_there)).collect();
    assert_eq!(found, [("23", "2026-05-03", true), ("24", "2026-05-01", false)]);
    let last = summary.effects[0].days.last().unwrap();
    assert_eq!((last.showing, last.comparisons), (2, 3));
    assert!((last.parameters["pitch_rad"] - 2.5_f64.to_radians()).abs() < 1e-12);
    assert_eq!(
        summary.sentence(),
        "1 of 3 robots need a calibration: 23 has pitch of the mount since 2026-05-03."
    );
    // The worst robot comes first.
    assert_eq!(summary.robots.iter().map(|robot| robot.healthy).collect::<Vec<_>>(), [2, 1, 1]);
}

#[test]
fn of_two_versions_the_newest_counts() {
    let of = |version: &str, pitch_deg| {
        let mut row = compared("a", "23", "2026-05-01", pitch_deg);
        version.clone_into(&mut row.version);
        row
    };
    let rows = newest(vec![of("0.9.0", Some(1.0)), of("0.10.0", None), of("0.2.0", Some(1.0))]);
    assert_eq!(rows.iter().map(|row| row.version.as_str()).collect::<Vec<_>>(), ["0.10.0"]);
    for builds in [["0.10.0+9", "0.10.0+10"], ["0.10.0+10", "0.10.0+9"]] {
        let rows = newest(vec![of(builds[0], None), of("0.9.0+11", None), of(builds[1], None)]);
        assert_eq!(rows.iter().map(|row| row.version.as_str()).collect::<Vec<_>>(), [builds[1]]);
    }
}

#[test]
fn the_places_with_the_fewest_headings_are_what_to_record_next() {
    use std::f64::consts::{FRAC_PI_2, PI};
    let field = reality_sim::FieldDimensions::preset("spl").unwrap();
    let place = |x_m: f64, y_m: f64, yaw_rad: f64, pictures: u64| json!({"x_m": x_m, "y_m": y_m, "yaw_rad": yaw_rad, "pictures": pictures});
    let mut places = Vec::new();
    for x in -5..5 {
        for y in -3..3 {
            // Half a turn to the left is half a turn to the right.
            let headings: &[f64] = if (x, y) == (1, -1) { &[PI, -PI] } else { &[PI, FRAC_PI_2] };
            places.extend(headings.iter().map(|yaw| place(f64::from(x) + 0.5, f64::from(y) + 0.5, *yaw, 4)));
        }
    }
    let report = json!({"field": field, "places": places});
    let rows = [row("tag", "a", "23", "2026-05-01", &report)];
    let coverage = &Summary::new(&rows).coverage[0];
    let emptiest = coverage.emptiest()[0];
    assert_eq!((emptiest.x_m, emptiest.y_m, emptiest.pictures, emptiest.headings), (1.5, -0.5, 8, 1));
    assert!(coverage.cells.iter().all(|cell| cell.pictures == 8));
}

#[test]
fn what_robots_are_called_is_no_part_of_the_page() {
    let rows = [compared("<b>", "<script>", "2026-05-01", Some(1.0))];
    let page = super::page::page(&Summary::new(&rows));
    assert!(page.contains("&lt;script&gt;") && !page.contains("<script>"));
}
