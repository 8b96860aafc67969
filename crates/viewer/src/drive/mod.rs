//! Drive: a robot anywhere on the field, and what its camera would see there, from recorded pictures.
//!
//! A [`source`] holds the pictures, the [`painter`]'s thread draws them, [`robot`], [`map`] and [`pictures`] are what is seen
//! and dragged; [`driving`] puts them together.

mod driving;
mod edges;
mod kind;
mod map;
mod painter;
mod pictures;
mod recorded;
mod robot;
mod source;
mod work_folder;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use eframe::egui::Ui;
use reality_sim_core::sequence::Sequence;
use reality_sim_synthesis::Archive;
use serde::{Deserialize, Serialize};

use self::{
    driving::Driving,
    kind::{PictureKind, Shown},
    map::Layers,
    pictures::Layout,
    recorded::Recorded,
    source::Source,
};
use crate::{
    device::{Device, list_ui},
    problems::Problems,
};

/// What is remembered of the panel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DriveSettings {
    pub layout: Layout,
    /// The picture alone or on the left, and the one on the right.
    pub left: PictureKind,
    pub right: PictureKind,
    /// What is shown of the left one.
    pub shown: Shown,
    /// Where the line of a wipe is, 0 to 1 from the left.
    pub wipe_share: f32,
    pub is_best_effort: bool,
    pub layers: Layers,
    /// Name of the device that draws and finds poses; where there is no such one, the first.
    pub device: String,
    /// How much of the window's width the field has.
    pub map_share: f32,
}

impl Default for DriveSettings {
    fn default() -> Self {
        Self {
            layout: Layout::default(),
            left: PictureKind::Auto,
            right: PictureKind::Simulated,
            shown: Shown::default(),
            wipe_share: 0.5,
            is_best_effort: false,
            layers: Layers::default(),
            device: String::new(),
            map_share: 0.37,
        }
    }
}

/// The panel. Where it is dropped, work under way is stopped and waited for: a temporary database is deleted then.
pub struct DrivePanel(State);

enum State {
    /// A recording of which no database has been made yet.
    Recorded(Recorded),
    Driving(Box<Driving>),
}

impl DrivePanel {
    /// For a recording: a database is made of it when the panel is first shown.
    pub fn of_recording(sequence: Arc<Sequence>) -> Self {
        Self(State::Recorded(Recorded::new(sequence)))
    }

    /// For a database.
    pub fn of_database(archive: Arc<Archive>) -> Self {
        Self(State::Driving(Box::new(Driving::new(Source::of_archive(archive)))))
    }

    /// Takes the pictures of a recording as the true ones to compare with. The error says why they are not comparable.
    pub fn compare_with(&mut self, probes: &Arc<Sequence>) -> Result<(), String> {
        match &mut self.0 {
            State::Driving(driving) => driving.compare_with(probes),
            State::Recorded(_) => Err(format!(
                "{}: nothing to compare with yet: wait until the database is made, and open it again",
                probes.folder.display()
            )),
        }
    }

    /// Shows the panel. True when a recording to compare with is asked for.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        settings: &mut DriveSettings,
        devices: &[Device],
        problems: &mut Problems,
    ) -> bool {
        if let State::Recorded(recorded) = &mut self.0
            && let Some(source) = recorded.ui(ui, settings, devices, problems)
        {
            self.0 = State::Driving(Box::new(Driving::new(source)));
        }
        match &mut self.0 {
            State::Recorded(_) => false,
            State::Driving(driving) => driving.ui(ui, settings, devices, problems),
        }
    }
}

/// The device of a person's choice, and a list to choose another from.
fn device_ui(ui: &mut Ui, chosen: &mut String, devices: &[Device]) {
    ui.horizontal(|ui| {
        let label = ui.label("Computed by");
        let list = list_ui(ui, devices, chosen, 150.0);
        list.labelled_by(label.id).on_hover_text("Where poses are found and pictures are drawn");
    });
}

/// So many things, in words: one needs no plural.
fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
