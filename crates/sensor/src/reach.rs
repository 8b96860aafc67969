//! What the effects of a model act on, by their forward models.

use glam::DVec2;
use reality_sim_core::{
    field::FieldDimensions,
    pose::{CameraPose, Motion2},
    sequence::CameraSetup,
};

use crate::{
    chain::Chain,
    model::{Model, Used},
};

/// What an effect acts on: what its forward model changes of a nominal camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reach {
    /// Lens, mount, height or field: where things are in the picture.
    pub geometry: bool,
    /// Clock and readout: at which pose a picture is taken.
    pub time: bool,
    /// Motions that the odometry reports.
    pub odometry: bool,
    /// Falloff of the lens and gain: what can be taken out of pictures.
    pub shading: bool,
}

impl Model {
    /// Returns the effects that change something, each with what it acts on for this camera and field. An effect that reaches
    /// none of it changes only what simulated pictures show: blur, noise, tone, light on the field.
    pub fn reaches(&self, setup: &CameraSetup, field: &FieldDimensions) -> Vec<(&'static str, Reach)> {
        let active = self.effects.iter().filter(|used| !used.is_neutral());
        active.filter_map(|used| Some((used.effect.id(), reach(used, setup, field)?))).collect()
    }

    /// Returns the model without the effects that a corrected camera contains: those on geometry, time and odometry.
    pub fn without_corrected(&self, setup: &CameraSetup, field: &FieldDimensions) -> Self {
        let stays = |used: &&Used| {
            reach(used, setup, field).is_none_or(|reach| !(reach.geometry || reach.time || reach.odometry))
        };
        Self { effects: self.effects.iter().filter(stays).cloned().collect() }
    }
}

/// Returns what an effect acts on; `None` where it leaves no valid camera.
fn reach(used: &Used, setup: &CameraSetup, field: &FieldDimensions) -> Option<Reach> {
    let nominal = Chain::nominal(setup, field);
    let chain = Chain::new(setup, field, &Model { effects: vec![used.clone()] }).ok()?;
    let pose = CameraPose { height_m: 0.5, pitch_rad: 0.3, roll_rad: 0.1, ..CameraPose::default() };
    let motion = Motion2 { forward_m: 0.2, left_m: 0.1, turn_rad: 0.1 };
    let camera = chain.camera();
    let corners = [DVec2::ZERO, DVec2::new(f64::from(camera.width), f64::from(camera.height)) / 3.0];
    Some(Reach {
        geometry: *camera != setup.camera || chain.field() != field || chain.mounted(pose) != pose,
        time: chain.clock_s() != 0.0 || chain.has_row_times(),
        odometry: chain.odometry(motion, 0.2) != nominal.odometry(motion, 0.2),
        shading: chain.changes_gain() || corners.iter().any(|&corner| chain.falloff(corner) != 1.0),
    })
}
