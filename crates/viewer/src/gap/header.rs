//! The answer: the verdict in a word, and all of it in a sentence.

use eframe::egui::{self, Color32, Label, RichText, Ui};
use reality_sim_gap::{
    ReferenceSource,
    report::{Report, Verdict},
};

/// Shows it.
pub fn ui(ui: &mut Ui, report: &Report) {
    ui.add_space(2.0);
    ui.horizontal_wrapped(|ui| {
        verdict_ui(ui, report.verdict);
        ui.add(Label::new(RichText::new(&report.summary).size(15.0)).wrap());
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak(facts(report));
        if !report.left_out.is_empty() {
            ui.weak(format!("· {} without a whole picture", report.left_out.len()))
                .on_hover_text(report.left_out.join("\n"));
        }
        if !report.poses.absorbed.is_empty() {
            ui.weak(format!("· {}", report.poses.absorbed));
        }
    });
}

fn verdict_ui(ui: &mut Ui, verdict: Verdict) {
    let (name, meaning, color) = words(verdict);
    egui::Frame::new()
        .fill(color)
        .corner_radius(4.0)
        .inner_margin(egui::Margin::symmetric(8, 2))
        .show(ui, |ui| {
            ui.add(Label::new(RichText::new(name).strong().size(16.0).color(Color32::WHITE)).extend());
        })
        .response
        .on_hover_text(meaning);
}

/// Its name, what it means, and a colour on which white is read.
fn words(verdict: Verdict) -> (&'static str, &'static str, Color32) {
    match verdict {
        Verdict::None => (
            "nothing missing",
            "Nothing is missing that these frames would show",
            Color32::from_rgb(45, 115, 75),
        ),
        Verdict::Named => {
            ("named", "Effects were named, and nothing significant is left", Color32::from_rgb(25, 95, 170))
        }
        Verdict::Confusable => (
            "confusable",
            "An effect was found that these frames cannot tell from others",
            Color32::from_rgb(135, 75, 150),
        ),
        Verdict::Unknown => (
            "unknown",
            "Something significant is left that is in no effect's shape",
            Color32::from_rgb(170, 50, 45),
        ),
        Verdict::Inconclusive => {
            ("inconclusive", "These frames cannot tell", Color32::from_rgb(105, 105, 105))
        }
    }
}

fn facts(report: &Report) -> String {
    let poses = match report.poses.source {
        ReferenceSource::Measured => "measured",
        ReferenceSource::Tagged => "found by the filter",
    };
    format!(
        "{} · {} frames, {} of them judged and in no fit · poses {poses} · gap {:.2} before, {:.2} after, in {} (floor {:.2})",
        report.recording,
        report.frames,
        report.judged_frames,
        report.gap.before,
        report.gap.after,
        report.gap.unit,
        report.gap.floor,
    )
}
