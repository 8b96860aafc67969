//! Making a database from a recording.

use std::sync::Arc;

use eframe::egui::{self, Ui};
use reality_sim_core::sequence::Sequence;

use super::{
    settings::DriveSettings,
    source::{Source, build, holds_back},
    widgets::{counted, device_ui},
};
use crate::{
    background::{Outcome, Task},
    device::{Device, by_name},
    problems::Problems,
};

/// Largest number of pictures for which a database is made without asking: it takes minutes, and a copy of all pictures.
const MOST_UNASKED: usize = 2000;

/// A recording without a database so far. Dropping it stops the work and waits for it.
pub struct Recorded {
    sequence: Arc<Sequence>,
    is_stopped: bool,
    work: Option<Task<Source>>,
}

impl Drop for Recorded {
    fn drop(&mut self) {
        if let Some(task) = self.work.take() {
            task.finish();
        }
    }
}

impl Recorded {
    /// Prepares a recording; work begins when it is first shown, if that takes only seconds.
    pub fn new(sequence: Arc<Sequence>) -> Self {
        Self { sequence, is_stopped: false, work: None }
    }

    /// Shows the progress; returns the source when it is ready.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        settings: &mut DriveSettings,
        devices: &[Device],
        problems: &mut Problems,
    ) -> Option<Source> {
        let is_quick = self.poses() > 0 && self.sequence.frames.len() <= MOST_UNASKED;
        if self.work.is_none() && is_quick && !self.is_stopped {
            self.start(ui, settings, devices);
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
                self.content(ui, settings, devices);
            });
        });
        None
    }

    /// Returns the number of pictures with reference poses.
    fn poses(&self) -> usize {
        self.sequence.reference_poses().flatten().count()
    }

    fn content(&mut self, ui: &mut Ui, settings: &mut DriveSettings, devices: &[Device]) {
        ui.heading(format!("Drive through “{}”", self.sequence.name));
        ui.add_space(8.0);
        ui.label(self.explanation());
        ui.add_space(12.0);
        // Rows are centred by their width, so the width is fixed here.
        let row = egui::vec2(420.0, 24.0);
        if let Some(task) = &self.work {
            ui.allocate_ui(row, |ui| task.ui(ui));
            return;
        }
        let has_poses = self.poses() > 0;
        if !has_poses {
            ui.allocate_ui(row, |ui| device_ui(ui, &mut settings.device, devices));
        }
        let button = if has_poses { "Build the database" } else { "Find the poses and build" };
        if ui.button(button).clicked() {
            self.start(ui, settings, devices);
        }
    }

    fn explanation(&self) -> String {
        let (frames, poses) = (self.sequence.frames.len(), self.poses());
        let pictures = counted(frames, "picture");
        if poses == 0 {
            return format!(
                "It has no ground truth: where its {pictures} were taken is not known. The particle filter can find the poses; pictures that it is not sure of are left out."
            );
        }
        let of_those =
            if poses < frames { format!("{poses} of its {pictures}") } else { format!("its {pictures}") };
        let held = if holds_back(poses) {
            " Every fifth is held back, as the true picture to compare with."
        } else {
            ""
        };
        let long = if frames > MOST_UNASKED {
            " So many take minutes, and as much room in the temporary folder as the recording itself."
        } else {
            ""
        };
        format!(
            "To drive, {of_those} are put into a temporary database by the poses of the ground truth.{held}{long}"
        )
    }

    fn start(&mut self, ui: &Ui, settings: &DriveSettings, devices: &[Device]) {
        let sequence = self.sequence.clone();
        let device = by_name(devices, &settings.device).cloned();
        self.is_stopped = false;
        self.work = Some(Task::spawn(ui.ctx(), "Making the database …", move |progress| {
            build(&sequence, device.as_ref(), progress)
        }));
    }
}
