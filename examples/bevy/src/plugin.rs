//! The plugin.

use bevy::{
    app::{App, Plugin, PostUpdate},
    asset::AssetEventSystems,
    ecs::schedule::{IntoScheduleConfigs, SystemSet},
    transform::TransformSystems,
};

use crate::looking::{look, show};

/// Plugin that lets every [`RealityCamera`](crate::RealityCamera) look once a frame, after Bevy has placed all entities.
#[derive(Debug, Clone, Copy, Default)]
pub struct RealityCameraPlugin;

/// Steps of [`RealityCameraPlugin`] in [`PostUpdate`], in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, SystemSet)]
pub enum RealityCameraSystems {
    /// Cameras look: frames and statuses are new.
    Look,
    /// Pictures are written into images.
    Show,
}

impl Plugin for RealityCameraPlugin {
    fn build(&self, app: &mut App) {
        let look = look.in_set(RealityCameraSystems::Look);
        let show = show.in_set(RealityCameraSystems::Show);
        let in_order = (look, show).chain();
        // Before assets report what has changed: the image is on the screen in the same frame.
        app.add_systems(PostUpdate, in_order.after(TransformSystems::Propagate).before(AssetEventSystems));
    }
}
