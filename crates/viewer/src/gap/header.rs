//! The answer: the verdict in one word, and the summary in a sentence.

use eframe::egui::{self, Color32, Label, RichText, Ui};
use reality_sim_core::sequence::counted;
use reality_sim_gap::report::{
    Report, Verdict,
    text::{GAP_UNIT, absorbed, digits, reference_source, summary, verdict_meaning, verdict_word},
};

/// Largest share of the window's height that the summary takes.
const SUMMARY_SHARE: f32 = 0.16;

/// Shows the answer.
pub fn ui(ui: &mut Ui, report: &Report) {
    ui.add_space(2.0);
    // A long sentence must leave room for the views.
    let height = SUMMARY_SHARE * ui.ctx().content_rect().height();
    egui::ScrollArea::vertical().id_salt("gap summary").max_height(height).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            verdict_ui(ui, report.verdict);
            ui.add(Label::new(RichText::new(summary(report)).size(15.0)).wrap());
        });
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak(facts(report));
        if !report.left_out.is_empty() {
            ui.weak(format!("· {} without a whole picture", report.left_out.len()))
                .on_hover_text(report.left_out.join("\n"));
        }
        let absorbed = absorbed(report.poses.source);
        if !absorbed.is_empty() {
            ui.weak(format!("· {absorbed}"));
        }
    });
}

fn verdict_ui(ui: &mut Ui, verdict: Verdict) {
    let name = verdict_word(verdict);
    egui::Frame::new()
        .fill(color(verdict))
        .corner_radius(4.0)
        .inner_margin(egui::Margin::symmetric(8, 2))
        .show(ui, |ui| {
            ui.add(Label::new(RichText::new(name).strong().size(16.0).color(Color32::WHITE)).extend());
        })
        .response
        .on_hover_text(verdict_meaning(verdict));
}

/// Returns a background colour on which white is readable.
fn color(verdict: Verdict) -> Color32 {
    match verdict {
        Verdict::None => Color32::from_rgb(45, 115, 75),
        Verdict::Named => Color32::from_rgb(25, 95, 170),
        Verdict::Confusable => Color32::from_rgb(135, 75, 150),
        Verdict::Unknown => Color32::from_rgb(170, 50, 45),
        Verdict::Inconclusive => Color32::from_rgb(105, 105, 105),
    }
}

fn facts(report: &Report) -> String {
    let [before, after, floor] =
        [report.gap.before, report.gap.after, report.gap.floor].map(|size| digits(size, 3));
    format!(
        "{} · {}, {} of them held out · poses {} · gap {before} before, {after} after, in {GAP_UNIT} (floor {floor})",
        report.recording,
        counted(report.frames, "frame"),
        report.held_out_frames,
        reference_source(report.poses.source),
    )
}
