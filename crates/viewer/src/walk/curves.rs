//! Curves over the recording's time; a click leads to that time.

use eframe::egui::{Color32, Ui};
use egui_plot::{HoverPosition, Line, Plot, PlotPoints, Points, VLine};
use reality_sim_core::sequence::Sequence;

use super::{frame::Record, history::History};
use crate::colors;

/// Points of a curve at most: more than a curve is wide in pixels, and than can be drawn in no time.
const MOST_POINTS: usize = 1000;

/// One curve: its title with the unit, and where its values come from.
struct Curve {
    title: &'static str,
    explanation: &'static str,
    value: fn(&Record) -> Option<f64>,
    color: Color32,
}

const CURVES: [Curve; 4] = [
    Curve {
        title: "error, cm",
        explanation: "Distance on the ground between the pose found and the true one",
        value: |record| record.error_m.map(|metres| 100.0 * metres),
        color: colors::POSE,
    },
    Curve {
        title: "effective sample size",
        explanation: "Of the filter's last iteration: as many equally heavy particles would be worth as much",
        value: |record| Some(record.effective_sample_size),
        color: colors::PARTICLE,
    },
    Curve {
        title: "spread, cm",
        explanation: "Root mean squared distance of the weighted particles from the filter's pose",
        value: |record| Some(100.0 * record.spread_m),
        color: colors::PARTICLE,
    },
    Curve {
        title: "ms a frame",
        explanation: "Time that filter, search and fit took, decoding and drawing excluded",
        value: |record| Some(record.milliseconds),
        color: Color32::from_rgb(110, 180, 110),
    },
];

/// Draws the curves side by side; gives the frame that was clicked.
pub fn ui(ui: &mut Ui, sequence: &Sequence, history: &History, at: usize, height: f32) -> Option<usize> {
    let has_truth = sequence.groundtruth.iter().any(Option::is_some);
    let shown = CURVES.iter().skip(usize::from(!has_truth));
    let count = CURVES.len() - usize::from(!has_truth);
    let mut clicked = None;
    ui.columns(count, |columns| {
        for (curve, ui) in shown.zip(columns) {
            clicked = clicked.or(curve.ui(ui, sequence, history, at, height));
        }
    });
    clicked
}

impl Curve {
    fn ui(
        &self,
        ui: &mut Ui,
        sequence: &Sequence,
        history: &History,
        at: usize,
        height: f32,
    ) -> Option<usize> {
        let now = history.records().find(|record| record.index == at).and_then(self.value);
        let title =
            now.map_or_else(|| self.title.to_owned(), |value| format!("{}: {}", self.title, rounded(value)));
        ui.label(title).on_hover_text(self.explanation);
        let step = sequence.frames.len().div_ceil(MOST_POINTS);
        let points = |is_wanted: &dyn Fn(&Record) -> bool| -> PlotPoints<'_> {
            let wanted = history.records().filter(|record| is_wanted(record));
            wanted
                .filter_map(|record| Some([time_s(sequence, record.index), (self.value)(record)?]))
                .collect()
        };
        let (all, searched) = (points(&|record| record.index % step == 0), points(&|record| record.searched));
        let grey = ui.visuals().weak_text_color();
        let playhead = VLine::new("", time_s(sequence, at)).color(grey).width(1.0).allow_hover(false);
        let response = plot(self.title, sequence, height).show(ui, |plot| {
            plot.vline(playhead);
            plot.line(Line::new(self.title, all).color(self.color).width(1.5));
            plot.points(Points::new("searched", searched).color(colors::TRUTH).radius(3.0));
            plot.pointer_coordinate()
        });
        let clicked_s = response.response.clicked().then_some(response.inner?.x)?;
        Some(frame_at(sequence, clicked_s))
    }
}

/// Axes over the whole recording, that neither move nor zoom.
fn plot<'a>(name: &str, sequence: &Sequence, height: f32) -> Plot<'a> {
    Plot::new(name)
        .height(height)
        .include_x(0.0)
        .include_x(time_s(sequence, sequence.frames.len() - 1))
        .include_y(0.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_axes([true, true])
        .y_axis_min_width(28.0)
        .x_axis_formatter(|mark, _| format!("{} s", mark.value))
        .label_formatter(|hover: &HoverPosition<'_>| match hover {
            HoverPosition::NearDataPoint { position, .. } => {
                Some(format!("{:.1} s: {:.2}", position.x, position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
}

/// Time since the first frame.
fn time_s(sequence: &Sequence, index: usize) -> f64 {
    sequence.frames[index].timestamp_s - sequence.frames[0].timestamp_s
}

/// Three digits.
fn rounded(value: f64) -> String {
    let decimals = if value < 1.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.decimals$}")
}

/// The frame nearest to a time after the first one.
fn frame_at(sequence: &Sequence, time_s: f64) -> usize {
    let wanted_s = sequence.frames[0].timestamp_s + time_s;
    let after = sequence.frames.partition_point(|frame| frame.timestamp_s < wanted_s);
    let distance = |index: &usize| {
        sequence.frames.get(*index).map_or(f64::INFINITY, |frame| (frame.timestamp_s - wanted_s).abs())
    };
    [after.saturating_sub(1), after]
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or_default()
}
