//! Pieces of the panel that several of its parts show.

use eframe::egui::{self, Color32, Stroke, Ui, Vec2};
use reality_sim_synthesis::ORIGIN_HUES;

use crate::device::{Device, list_ui};

/// The device of a person's choice, and a list to choose another from.
pub fn device_ui(ui: &mut Ui, chosen: &mut String, devices: &[Device]) {
    ui.horizontal(|ui| {
        let label = ui.label("Computed by");
        let list = list_ui(ui, devices, chosen, 150.0);
        list.labelled_by(label.id).on_hover_text("Where poses are found and pictures are drawn");
    });
}

/// Returns a number of things in words: one needs no plural.
pub fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// The colour of the image that is so many-th in use.
pub fn hue(number: usize) -> Color32 {
    let [red, green, blue] = ORIGIN_HUES[number % ORIGIN_HUES.len()];
    Color32::from_rgb(red, green, blue)
}

/// A small square of a colour, in a text.
pub fn swatch(color: Color32) -> egui::Atom<'static> {
    egui::Atom::paint(Vec2::splat(10.0), move |ui, args| {
        let stroke = Stroke::new(1.0, Color32::from_gray(110));
        ui.painter().rect(args.rect, 2.0, color, stroke, egui::StrokeKind::Inside);
    })
}
