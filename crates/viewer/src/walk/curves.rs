//! Curves over playback time; a click jumps to that time.

use eframe::egui::{self, Color32, Ui};
use egui_plot::{GridMark, HoverPosition, Line, Plot, PlotPoints, Points, VLine};

use super::{
    frame::Record,
    history::{History, Thinned},
    timeline::Timeline,
};
use crate::colors;

/// One curve: its title with the unit, and the source of its values.
struct Curve {
    title: &'static str,
    explanation: &'static str,
    value: fn(&Record) -> Option<f64>,
    color: Color32,
}

const ERROR: Curve = Curve {
    title: "error, cm",
    explanation: "Distance on the ground between the pose found and the true one",
    value: |record| record.error_m.map(|metres| 100.0 * metres),
    color: colors::POSE,
};

const OTHERS: [Curve; 3] = [
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

/// Text at the end of all tooltips.
const SIGNS: &str = "White dots: the field was searched. Broken lines: settings were changed. Time as it is played, pauses cut short; a click leads there.";

/// Draws the curves side by side; returns the frame that was clicked.
pub fn ui(
    ui: &mut Ui,
    timeline: &Timeline,
    history: &History,
    at: usize,
    has_truth: bool,
    height: f32,
) -> Option<usize> {
    let curves: Vec<&Curve> = has_truth.then_some(&ERROR).into_iter().chain(&OTHERS).collect();
    let records = history.records();
    let mut clicked = None;
    ui.columns(curves.len(), |columns| {
        for (curve, ui) in curves.into_iter().zip(columns) {
            curve.title_ui(ui, history.get(at));
            clicked = clicked.or(curve.plot_ui(ui, timeline, history, &records, at, height));
        }
    });
    clicked
}

impl Curve {
    fn title_ui(&self, ui: &mut Ui, now: Option<&Record>) {
        let value = now.and_then(self.value);
        let title = value
            .map_or_else(|| self.title.to_owned(), |value| format!("{}: {}", self.title, rounded(value)));
        ui.add(egui::Label::new(title).truncate()).on_hover_text(format!("{}\n{SIGNS}", self.explanation));
    }

    fn plot_ui(
        &self,
        ui: &mut Ui,
        timeline: &Timeline,
        history: &History,
        records: &Thinned<Record>,
        at: usize,
        height: f32,
    ) -> Option<usize> {
        let point = |record: &Record| Some([timeline.at_s(record.index), (self.value)(record)?]);
        let grey = ui.visuals().weak_text_color();
        let dot = ui.visuals().strong_text_color();
        let is_empty = records.points.is_empty();
        let mut plot = plot(self.title, timeline, height);
        if is_empty {
            // Without a value, the axis would have its zero in the middle and mean nothing.
            plot = plot.include_y(1.0).y_axis_formatter(|_, _| String::new());
        }
        let response = plot.show(ui, |plot| {
            plot.vline(VLine::new("", timeline.at_s(at)).color(grey).width(1.0).allow_hover(false));
            for &index in history.changes() {
                let change = VLine::new("", timeline.at_s(index)).color(grey).width(1.0).allow_hover(false);
                plot.vline(change.style(egui_plot::LineStyle::dashed_dense()));
            }
            for run in runs(records) {
                let points: PlotPoints<'_> = run.iter().filter_map(point).collect();
                if run.len() == 1 {
                    plot.points(Points::new(self.title, points).color(self.color).radius(1.5));
                } else {
                    plot.line(Line::new(self.title, points).color(self.color).width(1.5).allow_band(false));
                }
            }
            let searched: PlotPoints<'_> = history.searched().iter().filter_map(point).collect();
            plot.points(Points::new("searched", searched).color(dot).radius(2.5));
            plot.pointer_coordinate()
        });
        if is_empty {
            let (center, font) = (response.response.rect.center(), egui::FontId::proportional(12.0));
            ui.painter().text(center, egui::Align2::CENTER_CENTER, "no values yet", font, grey);
        }
        let clicked_s = response.response.clicked().then_some(response.inner?.x)?;
        Some(timeline.frame_at(clicked_s))
    }
}

/// Splits the records into runs of consecutive frames, so that no curve crosses frames that were never seen.
fn runs(records: &Thinned<Record>) -> impl Iterator<Item = &[Record]> {
    // Thinned records of consecutive frames are a step apart; a single missing frame is not shown as a gap.
    let widest = if records.step == 1 { 1 } else { 2 * records.step };
    records.points.chunk_by(move |a, b| b.index - a.index <= widest)
}

/// Returns a plot over the whole recording that can be neither moved nor zoomed.
fn plot<'a>(name: &str, timeline: &Timeline, height: f32) -> Plot<'a> {
    let marks = time_marks(timeline.end_s());
    Plot::new(name)
        .height(height)
        .include_x(0.0)
        .include_x(timeline.end_s())
        .include_y(0.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_axes([true, true])
        .y_axis_min_width(28.0)
        .x_grid_spacer(move |_| marks.clone())
        .x_axis_formatter(|mark, _| format!("{} s", (1e3 * mark.value).round() / 1e3))
        .label_formatter(|hover: &HoverPosition<'_>| match hover {
            HoverPosition::NearDataPoint { position, .. } => {
                Some(format!("{:.1} s: {:.2}", position.x, position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
}

/// Returns two or three round times, including zero.
fn time_marks(end_s: f64) -> Vec<GridMark> {
    let rough_s = (0.45 * end_s).max(0.01);
    let power = 10_f64.powf(rough_s.log10().floor());
    let step_size = [8.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.0]
        .map(|digit| digit * power)
        .into_iter()
        .find(|step| *step <= rough_s);
    let step_size = step_size.unwrap_or(power);
    let count = (end_s / step_size).floor() as usize;
    (0..=count).map(|number| GridMark { value: number as f64 * step_size, step_size }).collect()
}

/// Writes a value with three digits.
fn rounded(value: f64) -> String {
    let decimals = if value < 1.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_two_or_three_round_times() {
        for end_s in [0.2, 0.9, 1.0, 11.8, 60.0, 99.0, 4000.0, 6543.0] {
            let marks: Vec<f64> = time_marks(end_s).iter().map(|mark| mark.value).collect();
            assert!((3..=5).contains(&marks.len()), "{end_s}: {marks:?}");
            assert!(marks[0] == 0.0 && marks[marks.len() - 1] <= end_s, "{end_s}: {marks:?}");
        }
        assert_eq!(time_marks(0.0).len(), 1);
    }
}
