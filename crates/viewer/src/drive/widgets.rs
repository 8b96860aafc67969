//! Pieces of the panel that several of its parts show.

use eframe::egui::Ui;

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
