//! Widgets that several parts of the panel share.

use eframe::egui::{self, Color32, Stroke, Ui, Vec2};
use reality_sim_synthesis::ORIGIN_HUES;

use crate::device::{Device, list_ui};

/// Shows the chosen device, and a list for choosing another.
pub fn device_ui(ui: &mut Ui, chosen: &mut String, devices: &[Device]) {
    ui.horizontal(|ui| {
        let label = ui.label("Computed by");
        let list = list_ui(ui, devices, chosen, 150.0);
        list.labelled_by(label.id).on_hover_text("Where poses are found and pictures are drawn");
    });
}

/// Returns a number of things in words, without a plural for one.
pub fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Returns the colour of the n-th image in use.
pub fn hue(number: usize) -> Color32 {
    let [red, green, blue] = ORIGIN_HUES[number % ORIGIN_HUES.len()];
    Color32::from_rgb(red, green, blue)
}

/// Returns a small coloured square for use in text.
pub fn swatch(color: Color32) -> egui::Atom<'static> {
    egui::Atom::paint(Vec2::splat(10.0), move |ui, args| {
        let stroke = Stroke::new(1.0, Color32::from_gray(110));
        ui.painter().rect(args.rect, 2.0, color, stroke, egui::StrokeKind::Inside);
    })
}
