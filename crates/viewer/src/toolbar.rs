//! Toolbar along the top: panels, opening, light or dark theme, screenshot, help.

use std::path::Path;

use eframe::egui::{self, ThemePreference, Ui};

use crate::shortcuts::{self, Action};

/// The panels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PanelKind {
    #[default]
    Walk,
    Drive,
    Gap,
}

/// Data shown in the toolbar.
pub struct Toolbar<'a> {
    /// Panels that have something to show.
    pub panels: &'a [PanelKind],
    pub shown: PanelKind,
    /// Path shown by the current panel.
    pub open: Option<&'a Path>,
    pub theme: ThemePreference,
}

impl Toolbar<'_> {
    /// Shows the toolbar; a click returns the same action as its key.
    pub fn ui(&self, ui: &mut Ui) -> Option<Action> {
        egui::Panel::top("toolbar").show(ui, |ui| ui.horizontal(|ui| self.content(ui)).inner).inner
    }

    fn content(&self, ui: &mut Ui) -> Option<Action> {
        let mut clicked = None;
        for &panel in self.panels {
            let (text, action) = match panel {
                PanelKind::Walk => ("Walk", Action::Walk),
                PanelKind::Drive => ("Drive", Action::Drive),
                PanelKind::Gap => ("Gap", Action::Gap),
            };
            if ui
                .selectable_label(panel == self.shown, egui::RichText::new(text).strong().size(15.0))
                .clicked()
            {
                clicked = Some(action);
            }
        }
        ui.separator();
        let mut button = |ui: &mut Ui, text: &str, action: Action, what: &str| {
            let hover = format!("{what} ({})", shortcuts::name(ui, action));
            if ui.button(text).on_hover_text(hover).clicked() {
                clicked = Some(action);
            }
        };
        button(ui, "Open…", Action::OpenPath, "Open a recording, a database or a report");
        if let Some(path) = self.open {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            ui.add(egui::Label::new(name).truncate()).on_hover_text(path.display().to_string());
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            button(ui, "?", Action::Help, "Keys and mouse");
            button(ui, "Screenshot", Action::Screenshot, "Save a picture of this window");
            let theme = match self.theme {
                ThemePreference::System => "System",
                ThemePreference::Light => "Light",
                ThemePreference::Dark => "Dark",
            };
            button(ui, theme, Action::Theme, "Light, dark, or as the system has it");
        });
        clicked
    }
}
