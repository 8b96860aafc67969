//! Residuals over time, without and with the effects found.

use eframe::egui::{Ui, Vec2};
use egui_plot::{HoverPosition, Line, Plot, PlotPoints, Points};
use reality_sim_gap::{
    Channel,
    report::{
        Course,
        text::{channel_scale, digits},
    },
};

use super::{side::Side, table::words, title::title_ui};

/// Draws both curves; held-out frames have dots.
pub fn ui(ui: &mut Ui, course: &Course, channel: Channel, room: Vec2) {
    title_ui(
        ui,
        "Over time: without (orange), with (green)",
        "Size of each frame's residuals, robust against robots in the way. Dots: held-out frames, which no fit has seen",
    );
    let Some(first_s) = course.time_s.first().copied() else { return words(ui, room, "no frames") };
    let (factor, unit) = channel_scale(channel);
    let plot = Plot::new("gap course")
        .width(room.x)
        .height(room.y)
        .include_y(0.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .y_axis_min_width(28.0)
        .x_axis_formatter(|mark, _| format!("{} s", digits(mark.value, 3)))
        .label_formatter(move |hover: &HoverPosition<'_>| match hover {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{:.2} s: {} {unit}", position.x, digits(position.y, 3)))
            }
            HoverPosition::Elsewhere { .. } => None,
        });
    plot.show(ui, |plot| {
        for side in Side::ALL {
            // Where the curves coincide, the wider one below stays visible.
            let width = *side.of(&[3.5, 1.5]);
            for run in runs(course, side) {
                let line = Line::new(side.name(), PlotPoints::from(points(course, &run, first_s, factor)));
                plot.line(line.color(side.color()).width(width).allow_band(false));
            }
            let held_out: Vec<_> = runs(course, side).concat();
            let held_out: Vec<_> =
                held_out.into_iter().filter(|(frame, _)| course.held_out[*frame]).collect();
            let dots = Points::new(side.name(), PlotPoints::from(points(course, &held_out, first_s, factor)));
            plot.points(dots.color(side.color()).radius(*side.of(&[4.0, 3.0])));
        }
    });
}

/// Returns runs of frames with values, split where nothing was measured, so that no curve crosses such gaps.
fn runs(course: &Course, side: Side) -> Vec<Vec<(usize, f64)>> {
    let values = side.of_course(course);
    let runs = values.split(Option::is_none);
    let mut start = 0;
    runs.map(|run| {
        let first = start;
        start += run.len() + 1;
        run.iter().enumerate().filter_map(|(place, value)| Some((first + place, (*value)?))).collect()
    })
    .filter(|run: &Vec<_>| !run.is_empty())
    .collect()
}

/// Returns times from the first frame on, and values multiplied by a factor.
fn points(course: &Course, values: &[(usize, f64)], first_s: f64, factor: f64) -> Vec<[f64; 2]> {
    values.iter().map(|(frame, value)| [course.time_s[*frame] - first_s, factor * value]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_ends_where_nothing_was_measured_and_begins_again() {
        let before = vec![None, Some(1.0), Some(2.0), None, None, Some(5.0)];
        let course = Course {
            time_s: (0..6).map(|frame| 10.0 + f64::from(frame)).collect(),
            held_out: vec![false; 6],
            after: vec![None; 6],
            before,
        };
        assert_eq!(runs(&course, Side::Without), [vec![(1, 1.0), (2, 2.0)], vec![(5, 5.0)]]);
        assert!(runs(&course, Side::With).is_empty());
        assert_eq!(points(&course, &[(5, 5.0)], 10.0, 100.0), [[5.0, 500.0]]);
    }
}
