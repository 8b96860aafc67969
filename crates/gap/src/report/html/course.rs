//! Time course of a channel's residuals, as curves.

use std::fmt::Write;

use super::text::escape;
use crate::{
    measurement::quantity::Channel,
    report::data::Course,
    report::text::{channel_scale, channel_title, rounded},
};

/// Width and height of the drawing.
const SIZE: [f64; 2] = [720.0, 200.0];
/// Left, top, right and bottom of the plot area within the drawing.
const PLOT: [f64; 4] = [54.0, 10.0, 710.0, 162.0];
/// Approximate number of ticks of an axis.
const TICKS: f64 = 5.0;

/// Mapping from time and value to the drawing.
struct Scale {
    from_s: f64,
    duration_s: f64,
    largest: f64,
}

impl Scale {
    fn x(&self, time_s: f64) -> f64 {
        PLOT[0] + (PLOT[2] - PLOT[0]) * (time_s - self.from_s) / self.duration_s
    }

    fn y(&self, value: f64) -> f64 {
        PLOT[3] - (PLOT[3] - PLOT[1]) * value / self.largest
    }
}

/// Draws the curves before and after, with the held-out frames marked, and the noise floor if it is known.
pub(super) fn drawing(course: &Course, channel: Channel, floor: Option<f64>) -> String {
    let (factor, unit) = channel_scale(channel);
    let scaled = |values: &[Option<f64>]| -> Vec<(f64, f64, bool)> {
        let held_out = course.held_out.iter().copied().chain(std::iter::repeat(false));
        let points = course.time_s.iter().zip(values).zip(held_out);
        points
            // Missing measurements interrupt a curve.
            .map(|((time_s, value), held_out)| (*time_s, factor * value.unwrap_or(f64::NAN), held_out))
            .collect()
    };
    let (before, after) = (scaled(&course.before), scaled(&course.after));
    let floor = floor.map(|floor| factor * floor).filter(|floor| floor.is_finite());
    let Some(scale) = scale(&before, &after, floor) else {
        return "<p class=\"quiet\">Nothing was measured over time.</p>\n".to_owned();
    };
    let label = format!("{} over time, before and after", channel.name());
    format!(
        "<figure><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}{}{}{}{}</svg>\
         <figcaption>{}</figcaption></figure>\n",
        SIZE[0],
        SIZE[1],
        escape(&label),
        axes(&scale),
        floor.map_or_else(String::new, |floor| level(&scale, floor)),
        // The dashed curve is on top, so that both are visible where they coincide.
        curve(&after, &scale, ["after", "held-out"]),
        curve(&before, &scale, ["before", "held-out-before"]),
        KEY,
        caption(channel, unit),
    )
}

const KEY: &str = "<path class=\"before\" d=\"M60 193H85\"/><text x=\"90\" y=\"197\">before</text>\
                   <path class=\"after\" d=\"M150 193H175\"/><text x=\"180\" y=\"197\">after</text>\
                   <path class=\"floor\" d=\"M230 193H255\"/><text x=\"260\" y=\"197\">noise floor</text>\
                   <circle class=\"held-out\" cx=\"345\" cy=\"193\" r=\"2.5\"/>\
                   <text x=\"353\" y=\"197\">held-out frame</text>";

/// Returns what the curves show, with the unit.
fn caption(channel: Channel, unit: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(", {unit}") };
    escape(&format!(
        "{} over time: usual size of each frame's residuals (1.48 times their median){unit}",
        channel_title(channel)
    ))
}

/// Returns the scale of the drawing. None if nothing was measured.
fn scale(before: &[(f64, f64, bool)], after: &[(f64, f64, bool)], floor: Option<f64>) -> Option<Scale> {
    let measured =
        || before.iter().chain(after).filter(|(time_s, value, _)| time_s.is_finite() && value.is_finite());
    let from_s = measured().map(|point| point.0).reduce(f64::min)?;
    let to_s = measured().map(|point| point.0).reduce(f64::max)?;
    let largest = measured().map(|point| point.1).chain(floor).reduce(f64::max)?;
    let positive = |length: f64| if length > 0.0 { length } else { 1.0 };
    Some(Scale { from_s, duration_s: positive(to_s - from_s), largest: 1.05 * positive(largest) })
}

/// Draws the ticks of both axes with their labels.
fn axes(scale: &Scale) -> String {
    let mut svg = String::new();
    let [left, top, right, bottom] = PLOT;
    for (value, text) in ticks(scale.largest) {
        let y = scale.y(value);
        let _ = write!(
            svg,
            "<path class=\"axis\" d=\"M{left} {y:.1}H{right}\"/><text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 5.0,
            y + 4.0,
            text
        );
    }
    for (time_s, text) in ticks(scale.duration_s) {
        let x = scale.x(scale.from_s + time_s);
        let _ = write!(
            svg,
            "<path class=\"axis\" d=\"M{x:.1} {top}V{bottom}\"/><text x=\"{x:.1}\" y=\"{:.0}\" text-anchor=\"middle\">{} s</text>",
            bottom + 14.0,
            text
        );
    }
    svg
}

/// Draws a horizontal line at a value.
fn level(scale: &Scale, value: f64) -> String {
    format!("<path class=\"floor\" d=\"M{} {:.1}H{}\"/>", PLOT[0], scale.y(value), PLOT[2])
}

/// Draws a curve with gaps, and dots on the held-out frames.
fn curve(points: &[(f64, f64, bool)], scale: &Scale, [line, dot]: [&str; 2]) -> String {
    let (mut path, mut dots, mut pen_down) = (String::new(), String::new(), false);
    for &(time_s, value, held_out) in points {
        let (x, y) = (scale.x(time_s), scale.y(value));
        if !(x.is_finite() && y.is_finite()) {
            pen_down = false;
            continue;
        }
        let _ = write!(path, "{}{x:.1} {y:.1}", if pen_down { "L" } else { "M" });
        pen_down = true;
        if held_out {
            let _ = write!(dots, "<circle class=\"{dot}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\"/>");
        }
    }
    format!("<path class=\"{line}\" d=\"{path}\"/>{dots}")
}

/// Returns round numbers from 0 to the largest value, with their labels.
fn ticks(largest: f64) -> impl Iterator<Item = (f64, String)> {
    let rough = largest / TICKS;
    let magnitude = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * magnitude).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(largest);
    let decimals = -step.log10().floor().min(0.0) as i32;
    let values = (0..=TICKS as u32 + 1).map(move |index| step * f64::from(index));
    values.take_while(move |value| *value <= largest).map(move |value| (value, rounded(value, decimals)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_no_more_than_six() {
        let texts = |largest| ticks(largest).map(|tick| tick.1).collect::<Vec<String>>();
        assert_eq!(texts(1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(7.3), ["0", "2", "4", "6"]);
    }

    #[test]
    fn a_frame_without_measurement_interrupts_the_curve() {
        let course = Course {
            time_s: vec![5.0, 6.0, 7.0, 8.0],
            held_out: vec![false, true, false, true],
            before: vec![Some(1.0), Some(2.0), None, Some(1.5)],
            after: vec![Some(1.0); 3],
        };
        let svg = drawing(&course, Channel::Geometry, None);
        let path = svg.split("class=\"before\" d=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
        assert_eq!(path.matches('M').count(), 2);
        assert_eq!(svg.matches("held-out-before").count(), 2);
    }

    #[test]
    fn a_course_without_frames_says_so() {
        let course =
            Course { time_s: Vec::new(), held_out: Vec::new(), before: Vec::new(), after: Vec::new() };
        assert!(drawing(&course, Channel::Geometry, Some(1.0)).contains("Nothing was measured"));
    }
}
