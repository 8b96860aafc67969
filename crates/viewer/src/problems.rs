//! What went wrong, in the window, in words, until it has been read.

use eframe::egui::{self, RichText, Ui};

/// Messages kept: those that come first tell the cause.
const KEPT: usize = 4;

/// Messages that have not been dismissed.
#[derive(Debug, Default)]
pub struct Problems(Vec<String>);

impl Problems {
    /// Adds a message, once.
    pub fn add(&mut self, message: impl Into<String>) {
        let message = message.into();
        if self.0.len() < KEPT && !self.0.contains(&message) {
            self.0.push(message);
        }
    }

    /// Shows the messages above everything else.
    pub fn ui(&mut self, ui: &mut Ui) {
        if self.0.is_empty() {
            return;
        }
        let frame =
            egui::Frame::side_top_panel(ui.style()).fill(ui.visuals().error_fg_color.gamma_multiply(0.18));
        egui::Panel::top("problems").frame(frame).show(ui, |ui| {
            self.0.retain(|message| {
                let keep = |ui: &mut Ui| {
                    let is_kept = !ui.button("Dismiss").clicked();
                    if ui.button("Copy").clicked() {
                        ui.copy_text(message.clone());
                    }
                    ui.label(RichText::new("!").strong().color(ui.visuals().error_fg_color));
                    ui.add(egui::Label::new(message).wrap());
                    is_kept
                };
                ui.horizontal(keep).inner
            });
        });
    }
}
