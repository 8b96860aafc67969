//! Drive: a robot anywhere on the field, and what its camera would see there, from recorded pictures.
//!
//! A [`source`] holds the pictures, the [`painter`]'s thread draws them, [`robot`], [`map`] and [`pictures`] are what is seen
//! and dragged; [`driving`] puts them together.

mod driving;
mod kind;
mod map;
mod painter;
mod pictures;
mod robot;
mod source;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use eframe::egui::{self, Ui};
use reality_sim_core::sequence::Sequence;
use reality_sim_synthesis::Archive;
use serde::{Deserialize, Serialize};

use self::{
    driving::Driving,
    kind::{PictureKind, Shown},
    map::Layers,
    pictures::Layout,
    source::{Poses, Source, build},
};
use crate::{
    background::{Outcome, Task},
    device::Device,
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
        }
    }
}

/// The panel.
pub struct DrivePanel(State);

enum State {
    /// A recording of which no database has been made yet.
    Recorded(Recorded),
    Driving(Box<Driving>),
}

/// A recording on its way to a database.
struct Recorded {
    sequence: Arc<Sequence>,
    is_stopped: bool,
    work: Option<Task<Source>>,
}

impl DrivePanel {
    /// For a recording: a database is made of it when the panel is first shown.
    pub fn of_recording(sequence: Arc<Sequence>) -> Self {
        Self(State::Recorded(Recorded { sequence, is_stopped: false, work: None }))
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
            && let Some(source) = recorded.ui(ui, devices, problems)
        {
            self.0 = State::Driving(Box::new(Driving::new(source)));
        }
        match &mut self.0 {
            State::Recorded(_) => false,
            State::Driving(driving) => driving.ui(ui, settings, devices, problems),
        }
    }
}

impl Recorded {
    /// Shows how far it is; returns what was made of it.
    fn ui(&mut self, ui: &mut Ui, devices: &[Device], problems: &mut Problems) -> Option<Source> {
        let has_poses = self.sequence.groundtruth.iter().any(Option::is_some);
        if self.work.is_none() && has_poses && !self.is_stopped {
            self.start(ui, devices);
        }
        match self.work.as_ref().and_then(Task::poll) {
            Some(Outcome::Done(source)) => return Some(source),
            Some(Outcome::Cancelled) => (self.work, self.is_stopped) = (None, true),
            Some(Outcome::Failed(reason)) => {
                (self.work, self.is_stopped) = (None, true);
                problems.add(reason);
            }
            None => {}
        }
        egui::CentralPanel::default().show(ui, |ui| {
            ui.vertical_centered(|ui| {
                ui.add_space(0.3 * ui.available_height());
                ui.set_max_width(460.0);
                self.content(ui, has_poses, devices);
            });
        });
        None
    }

    fn content(&mut self, ui: &mut Ui, has_poses: bool, devices: &[Device]) {
        let name = &self.sequence.name;
        let pictures = self.sequence.frames.len();
        ui.heading(format!("Drive through “{name}”"));
        ui.add_space(8.0);
        if has_poses {
            ui.label(format!(
                "To drive, its {pictures} pictures are put into a temporary database by the poses of its ground truth. Every fifth is held back, as the true picture to compare with."
            ));
        } else {
            ui.label(format!(
                "It has no ground truth: where its {pictures} pictures were taken is not known. The particle filter can find the poses; pictures that it is not sure of are left out."
            ));
        }
        ui.add_space(12.0);
        match &self.work {
            Some(task) => {
                // Centred rows are as wide as they turn out to be: this one is told.
                ui.allocate_ui(egui::vec2(420.0, 24.0), |ui| task.ui(ui));
            }
            None => {
                let button = if has_poses { "Build the database" } else { "Find the poses and build" };
                if ui.button(button).clicked() {
                    self.start(ui, devices);
                }
            }
        }
    }

    fn start(&mut self, ui: &Ui, devices: &[Device]) {
        let (sequence, device) = (self.sequence.clone(), devices.first().cloned());
        let known = Poses::known(&sequence);
        let title = if known.is_some() { "Making the database …" } else { "Finding the poses …" };
        self.work = Some(Task::spawn(ui.ctx(), title, move |progress| {
            let poses = match known {
                Some(poses) => poses,
                None => Poses::found(&sequence, device.as_ref(), progress)?,
            };
            build(&sequence, poses, progress)
        }));
    }
}
