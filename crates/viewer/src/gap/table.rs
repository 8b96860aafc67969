//! Tables with wrapped cells: columns have fixed shares of the width, and rows grow with their text.

use eframe::egui::{self, Label, RichText, Ui};

/// Table with a title and a share of the width for each column.
pub struct Table<'a>(pub &'a [(&'a str, f32)]);

impl Table<'_> {
    /// Shows the column titles, and a line below them.
    pub fn heads_ui(&self, ui: &mut Ui) {
        self.row_ui(ui, |ui, column| {
            ui.add(Label::new(RichText::new(self.0[column].0).weak()).wrap());
        });
        ui.separator();
    }

    /// Shows a row; `cell` fills the column with the given number.
    pub fn row_ui(&self, ui: &mut Ui, mut cell: impl FnMut(&mut Ui, usize)) {
        let gap = ui.spacing().item_spacing.x;
        let width = ui.available_width() - gap * (self.0.len() - 1) as f32;
        ui.horizontal_top(|ui| {
            for (column, (_, share)) in self.0.iter().enumerate() {
                ui.vertical(|ui| {
                    ui.set_width((share * width).max(20.0));
                    cell(ui, column);
                });
            }
        });
    }

    /// Shows a row of texts.
    pub fn texts_ui(&self, ui: &mut Ui, texts: &[&str]) {
        self.row_ui(ui, |ui, column| {
            ui.add(Label::new(texts[column]).wrap());
        });
    }
}

/// Shows the title of a part of the evidence.
pub fn title(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(RichText::new(text).strong().size(15.0));
}

/// Shows text in the middle of an otherwise empty rectangle.
pub fn words(ui: &mut Ui, size: egui::Vec2, text: &str) {
    let layout = egui::Layout::centered_and_justified(egui::Direction::TopDown);
    ui.allocate_ui_with_layout(size, layout, |ui| ui.add(Label::new(RichText::new(text).weak()).wrap()));
}
