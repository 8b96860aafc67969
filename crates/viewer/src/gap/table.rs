//! Tables whose cells wrap: columns have shares of the width, rows the height that their words need.

use eframe::egui::{self, Label, RichText, Ui};

/// A table's columns: for each one its head, and its share of the width.
pub struct Table<'a>(pub &'a [(&'a str, f32)]);

impl Table<'_> {
    /// The heads, and a line below them.
    pub fn heads_ui(&self, ui: &mut Ui) {
        self.row_ui(ui, |ui, column| {
            ui.add(Label::new(RichText::new(self.0[column].0).weak()).wrap());
        });
        ui.separator();
    }

    /// A row; `cell` fills the column of a number.
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

    /// A row of texts.
    pub fn texts_ui(&self, ui: &mut Ui, texts: &[&str]) {
        self.row_ui(ui, |ui, column| {
            ui.add(Label::new(texts[column]).wrap());
        });
    }
}

/// What stands above a part of the evidence.
pub fn title(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(RichText::new(text).strong().size(15.0));
}

/// Words in the middle of a rectangle that has nothing else to show.
pub fn words(ui: &mut Ui, size: egui::Vec2, text: &str) {
    let layout = egui::Layout::centered_and_justified(egui::Direction::TopDown);
    ui.allocate_ui_with_layout(size, layout, |ui| ui.add(Label::new(RichText::new(text).weak()).wrap()));
}
