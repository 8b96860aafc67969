//! Messages about problems, shown in the window until they are dismissed.

use eframe::egui::{self, RichText, Ui};

/// Number of messages shown at a time: the first ones name the cause.
const SHOWN: usize = 4;
/// Number of messages kept until earlier ones are dismissed.
const KEPT: usize = 100;

/// Messages that have not been dismissed.
#[derive(Debug, Default)]
pub struct Problems(Vec<String>);

impl Problems {
    /// Adds a message, unless it is already there.
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
            let more = self.0.len().saturating_sub(SHOWN);
            let mut place = 0;
            self.0.retain(|message| {
                place += 1;
                if place > SHOWN {
                    return true;
                }
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
            if more > 0 {
                ui.weak(format!("and {more} more"));
            }
        });
    }
}
