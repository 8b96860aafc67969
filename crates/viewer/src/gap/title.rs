//! The title above each view.

use eframe::egui::{Align, Label, Layout, RichText, Ui, vec2};

/// Height of a view's title, points.
pub const TITLE_HEIGHT: f32 = 20.0;

/// Draws a view's title on one line, truncated if it is too long, with an explanation as a tooltip.
pub fn title_ui(ui: &mut Ui, text: &str, explanation: &str) {
    let size = vec2(ui.available_width(), TITLE_HEIGHT);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.add(Label::new(RichText::new(text).strong()).truncate()).on_hover_text(explanation);
    });
}
