//! stub
use crate::{device::Device, problems::Problems};
use eframe::egui::Ui;
use reality_sim_core::sequence::Sequence;
use reality_sim_synthesis::Archive;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct DriveSettings {}
pub struct DrivePanel {}
impl DrivePanel {
    pub fn of_recording(_sequence: Arc<Sequence>) -> Self {
        Self {}
    }
    pub fn of_database(_archive: Arc<Archive>) -> Self {
        Self {}
    }
    pub fn compare_with(&mut self, _probes: &Arc<Sequence>) -> Result<(), String> {
        Ok(())
    }
    /// True when a recording to compare with is asked for.
    pub fn ui(
        &mut self,
        _ui: &mut Ui,
        _settings: &mut DriveSettings,
        _devices: &[Device],
        _problems: &mut Problems,
    ) -> bool {
        false
    }
}
