//! Drive: a robot anywhere on the field, and its camera's picture there, made from recorded pictures.
//!
//! A [`source`] holds the pictures, and the [`painter`]'s thread draws them. [`robot`], [`map`] and [`pictures`] are the
//! visible parts; [`driving`] connects them.

mod driving;
mod edges;
mod kind;
mod layout;
mod map;
mod painter;
mod pictures;
mod recorded;
mod robot;
mod settings;
mod source;
mod widgets;
mod work_folder;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use eframe::egui::Ui;
use reality_sim_core::sequence::Sequence;
use reality_sim_synthesis::Archive;

pub use self::settings::DriveSettings;
use self::{driving::Driving, recorded::Recorded, source::Source};
use crate::{device::Device, problems::Problems};

/// Drive panel. Dropping it stops work under way and waits for it, so that a temporary database is deleted.
pub struct DrivePanel(State);

enum State {
    /// A recording without a database so far.
    Recorded(Recorded),
    Driving(Box<Driving>),
}

impl DrivePanel {
    /// Makes the panel of a recording: its database is made when the panel is first shown.
    pub fn of_recording(sequence: Arc<Sequence>) -> Self {
        Self(State::Recorded(Recorded::new(sequence)))
    }

    /// Makes the panel of a database.
    pub fn of_database(archive: Arc<Archive>) -> Self {
        Self(State::Driving(Box::new(Driving::new(Source::of_archive(archive)))))
    }

    /// Compares with the pictures of a recording as the truth. The error says why they cannot be compared.
    pub fn compare_with(&mut self, probes: &Arc<Sequence>) -> Result<(), String> {
        match &mut self.0 {
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
