//! stub
use crate::{device::Device, problems::Problems};
use eframe::egui::{Context, Ui};
use reality_sim_core::sequence::Sequence;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct WalkSettings {}
pub struct WalkPanel {}
impl WalkPanel {
    pub fn new(
        _ctx: &Context,
        _sequence: Arc<Sequence>,
        _devices: &[Device],
        _settings: &WalkSettings,
    ) -> Self {
        Self {}
    }
    pub fn ui(
        &mut self,
        _ui: &mut Ui,
        _settings: &mut WalkSettings,
        _devices: &[Device],
        _problems: &mut Problems,
    ) {
    }
}
