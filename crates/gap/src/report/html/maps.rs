//! Maps of residuals in the picture and on the field, as drawings.

use std::fmt::Write;

use glam::DVec2;
use reality_sim_core::field::{Curve, FieldDimensions};

use super::text::escape;
use crate::{measurement::quantity::Channel, report::data::Map, report::text::amount};

/// Width of a map in the drawing's units.
const WIDTH: f64 = 340.0;
/// Least and largest ratio of a map's height to its width.
const PROPORTIONS: [f64; 2] = [0.2, 1.5];
/// Fraction of the cells within the range of the colours. With the full range, a single outlier would make all other cells
/// pale.
const WITHIN: f64 = 0.96;
/// Number of steps of the legend.
const LEGEND: u32 = 40;
/// Number of points that a curved line is drawn with.
const BENDS: u32 = 48;
/// Colours from the least to the largest value: ColorBrewer's RdBu.
const COLORS: [[f64; 3]; 5] = [
    [33.0, 102.0, 172.0],
    [146.0, 197.0, 222.0],
    [238.0, 238.0, 238.0],
    [244.0, 165.0, 130.0],
    [178.0, 24.0, 43.0],
];

/// Subject of a map.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    pub(super) channel: Channel,
    /// Place of the residuals as text, such as "in the picture".
    pub(super) place: &'a str,
    /// Dimensions of the field whose lines are drawn, if the map shows the field.
    pub(super) field: Option<&'a FieldDimensions>,
}

/// Draws a map before and after in the same colours, with a legend.
pub(super) fn pair(map: &Map, subject: Subject<'_>) -> String {
    let Some(limit) = limit(map) else {
        return format!("<p class=\"quiet\">Nothing was measured {}.</p>\n", escape(subject.place));
    };
    let figure = |values: &[Option<f64>], when: &str| {
        let caption =
            escape(&format!("{} {}, {when}", super::text::capital(subject.channel.name()), subject.place));
        format!(
            "<figure>{}<figcaption>{caption}</figcaption></figure>",
            drawing(map, values, limit, subject, &caption)
        )
    };
    format!(
        "<div class=\"two maps\">{}{}</div>\n{}",
        figure(&map.before, "model as it was given"),
        figure(&map.after, "extended model"),
        legend(limit, subject)
    )
}

/// Returns the value of the strongest colours. None if nothing was measured.
fn limit(map: &Map) -> Option<f64> {
    let mut sizes: Vec<f64> = map
        .before
        .iter()
        .chain(&map.after)
        .flatten()
        .map(|value| value.abs())
        .filter(|size| size.is_finite())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let index = (WITHIN * sizes.len() as f64) as usize;
    sizes.get(index.min(sizes.len().saturating_sub(1))).map(|size| size.max(f64::MIN_POSITIVE))
}

fn drawing(map: &Map, values: &[Option<f64>], limit: f64, subject: Subject<'_>, caption: &str) -> String {
    let [left, top, right, bottom] = map.extent;
    let proportion = ((bottom - top) / (right - left)).abs();
    let is_place = proportion.is_finite() && proportion > 0.0;
    let height = WIDTH * if is_place { proportion.clamp(PROPORTIONS[0], PROPORTIONS[1]) } else { 0.75 };
    let from_world = |point: DVec2| {
        DVec2::new((point.x - left) / (right - left) * WIDTH, (point.y - top) / (bottom - top) * height)
    };
    let lines = subject.field.filter(|_| is_place).map_or_else(String::new, |field| lines(field, from_world));
    format!(
        "<svg viewBox=\"-1 -1 {:.0} {:.0}\" role=\"img\" aria-label=\"{caption}\">{}{lines}<rect class=\"frame\" x=\"0\" \
         y=\"0\" width=\"{WIDTH:.1}\" height=\"{height:.1}\"/></svg>",
        WIDTH + 2.0,
        height + 2.0,
        cells(map, values, height, limit, subject)
    )
}

/// Draws the measured cells, with their values as tooltips.
fn cells(map: &Map, values: &[Option<f64>], height: f64, limit: f64, subject: Subject<'_>) -> String {
    let (columns, rows) = (map.columns.max(1), map.rows.max(1));
    let DVec2 { x: cell_width, y: cell_height } =
        DVec2::new(WIDTH, height) / DVec2::new(columns as f64, rows as f64);
    let mut svg = String::new();
    for (index, value) in values.iter().enumerate().take(columns * rows) {
        let Some(value) = value.filter(|value| value.is_finite()) else { continue };
        let (x, y) = (cell_width * (index % columns) as f64, cell_height * (index / columns) as f64);
        let _ = write!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{cell_width:.1}\" height=\"{cell_height:.1}\" fill=\"{}\"><title>{}\
             </title></rect>",
            color(value / limit),
            escape(&value_text(value, subject))
        );
    }
    svg
}

/// Draws the field's lines dark with a light border, which is legible on every colour.
fn lines(field: &FieldDimensions, from_world: impl Fn(DVec2) -> DVec2) -> String {
    let mut path = String::new();
    for curve in field.curves() {
        let bends = if matches!(curve, Curve::Circle { .. }) { BENDS } else { 1 };
        for bend in 0..=bends {
            let point = from_world(curve.at(f64::from(bend) / f64::from(bends)).0);
            if point.is_finite() {
                let _ = write!(path, "{}{:.1} {:.1}", if bend == 0 { "M" } else { "L" }, point.x, point.y);
            }
        }
    }
    format!("<path class=\"under\" d=\"{path}\"/><path class=\"over\" d=\"{path}\"/>")
}

fn legend(limit: f64, subject: Subject<'_>) -> String {
    let step = WIDTH / f64::from(LEGEND);
    let mut svg = format!(
        "<div class=\"two maps\"><figure><svg viewBox=\"0 0 {WIDTH:.0} 30\" role=\"img\" aria-label=\"legend\">"
    );
    for index in 0..LEGEND {
        let part = 2.0 * (f64::from(index) + 0.5) / f64::from(LEGEND) - 1.0;
        let x = step * f64::from(index);
        let _ = write!(
            svg,
            "<rect x=\"{x:.1}\" y=\"0\" width=\"{:.1}\" height=\"12\" fill=\"{}\"/>",
            step + 0.3,
            color(part)
        );
    }
    let text = |x: f64, anchor: &str, value: f64| {
        let text = escape(&value_text(value, subject));
        format!("<text x=\"{x:.0}\" y=\"26\" text-anchor=\"{anchor}\">{text}</text>")
    };
    svg.push_str(&text(0.0, "start", -limit));
    svg.push_str(&text(0.5 * WIDTH, "middle", 0.0));
    svg.push_str(&text(WIDTH, "end", limit));
    let axes = if subject.field.is_some() { " x points to the right, y up." } else { "" };
    format!(
        "{svg}</svg></figure><figure><p class=\"quiet\">Middle (median) of measured − expected. Beyond the ends the colours stay; \
         blank: nothing was measured.{axes}</p></figure></div>\n"
    )
}

fn value_text(value: f64, subject: Subject<'_>) -> String {
    amount(subject.channel, value, subject.channel.unit(), 2)
}

/// Returns the colour of a value from −1 to 1.
fn color(value: f64) -> String {
    let place = (value.clamp(-1.0, 1.0) + 1.0) * 0.5 * (COLORS.len() - 1) as f64;
    let index = (place as usize).min(COLORS.len() - 2);
    let rest = place - index as f64;
    let [r, g, b] = std::array::from_fn(|channel| {
        (COLORS[index][channel] * (1.0 - rest) + COLORS[index + 1][channel] * rest) as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_run_from_blue_over_grey_to_red() {
        assert_eq!([-1.0, 0.0, 1.0].map(color), ["#2166ac", "#eeeeee", "#b2182b"]);
        assert_eq!(color(f64::INFINITY), color(1.0));
    }

    #[test]
    fn a_map_without_measurements_says_so() {
        let map = Map {
            columns: 2,
            rows: 1,
            extent: [f64::NAN; 4],
            before: vec![None; 2],
            after: vec![Some(f64::NAN)],
        };
        let subject = Subject { channel: Channel::Geometry, place: "in the picture", field: None };
        assert!(pair(&map, subject).contains("Nothing was measured in the picture"));
    }

    #[test]
    fn places_without_measurement_stay_blank() {
        let map = Map {
            columns: 2,
            rows: 2,
            extent: [0.0, 0.0, 640.0, 480.0],
            before: vec![Some(1.0), None, Some(-0.5), None],
            after: vec![Some(0.1), None, Some(f64::NAN), None],
        };
        let subject = Subject { channel: Channel::Geometry, place: "in the picture", field: None };
        assert_eq!(pair(&map, subject).matches("<title>").count(), 3);
    }

    #[test]
    fn the_left_touch_line_is_drawn_above_the_right_one() {
        let field = FieldDimensions::preset("humanoid-kidsize").unwrap();
        let extent = [-5.0, 4.0, 5.0, -4.0];
        let map = Map { columns: 1, rows: 1, extent, before: vec![Some(1.0)], after: vec![Some(0.0)] };
        let subject = Subject { channel: Channel::Geometry, place: "on the field", field: Some(&field) };
        let svg = drawing(&map, &map.before, 1.0, subject, "");
        let y = 0.5 * field.width_m;
        let left = WIDTH * (-0.5 * field.length_m + 5.0) / 10.0;
        assert!(svg.contains(&format!("M{left:.1} {:.1}", WIDTH * 0.8 * (4.0 - y) / 8.0)));
    }
}
