//! Drive: a robot anywhere on the field, and its camera's picture there, made from recorded pictures, with a ball and other
//! robots in it.
//!
//! A [`source`] holds the pictures, and the [`painter`]'s thread draws them: a [`wish`] goes to it, [`answer`]s come back.
//! [`robot`], [`things`], [`map`] and [`pictures`] are the visible parts; [`driving`] connects them.

mod answer;
mod driving;
mod edges;
mod hand;
mod kind;
mod layout;
mod legend;
mod map;
mod overlay;
mod painter;
mod pictures;
mod rate;
mod recorded;
mod robot;
mod settings;
mod source;
mod staging;
mod studio;
mod things;
mod things_ui;
mod widgets;
mod wish;
mod work_folder;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use eframe::egui::Ui;
use reality_sim_core::sequence::Sequence;
use reality_sim_sensor::Model;
use reality_sim_synthesis::Archive;

pub use self::settings::DriveSettings;
use self::{driving::Driving, recorded::Recorded, source::Source};
use crate::{device::Device, problems::Problems};

/// Drive panel. Dropping it stops work under way and waits for it, so that a temporary database is deleted.
pub struct DrivePanel {
    state: State,
    /// Effects of the camera, which things in the pictures go through.
    model: Option<Model>,
}

enum State {
    /// A recording without a database so far.
    Recorded(Recorded),
    Driving(Box<Driving>),
}

impl DrivePanel {
    /// Makes the panel of a recording: its database is made when the panel is first shown. Things in the pictures go through
    /// the effects of the model.
    pub fn of_recording(sequence: Arc<Sequence>, model: Option<Model>) -> Self {
        Self { state: State::Recorded(Recorded::new(sequence)), model }
    }

    /// Makes the panel of a database. Things in the pictures go through the effects of the model.
    pub fn of_database(archive: Arc<Archive>, model: Option<Model>) -> Self {
        let source = Source::of_archive(archive).with_model(model.clone());
        Self { state: State::Driving(Box::new(Driving::new(source))), model }
    }

    /// Compares with the pictures of a recording as the truth. The error says why they cannot be compared.
    pub fn compare_with(&mut self, probes: &Arc<Sequence>) -> Result<(), String> {
        match &mut self.state {
            State::Driving(driving) => driving.compare_with(probes),
            State::Recorded(_) => Err(format!(
                "{}: nothing to compare with yet: wait until the database is made, and open it again",
                probes.folder.display()
            )),
        }
    }

    /// Shows the panel. Returns true when the user asks for a recording to compare with.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        settings: &mut DriveSettings,
        devices: &[Device],
        problems: &mut Problems,
    ) -> bool {
        if let State::Recorded(recorded) = &mut self.state
            && let Some(source) = recorded.ui(ui, settings, devices, problems)
        {
            let source = source.with_model(self.model.clone());
            self.state = State::Driving(Box::new(Driving::new(source)));
        }
        match &mut self.state {
            State::Recorded(_) => false,
            State::Driving(driving) => driving.ui(ui, settings, devices, problems),
        }
    }
}
