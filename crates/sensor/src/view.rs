//! The world as cones of rays from a camera, and how much of a pixel each cone covers.
//!
//! A flat shape with straight edges is seen in the rays between planes through the projection centre, and so is the
//! side of a cylinder. Where a ray lies to such a plane is linear in the ray; the part of a pixel that an edge covers
//! is therefore found in closed form, whatever the distance and however thin the line.

mod cone;

use glam::{DMat3, Vec3};
use reality_sim_core::pose::CameraPose;

use self::cone::{Cone, Side};
use crate::{lens::RayPatch, world::World};

/// What a camera sees at a pose.
#[derive(Debug)]
pub(crate) struct View {
    background: Vec3,
    /// Each hides those before it.
    layers: Vec<Layer>,
}

/// Cones of one colour.
#[derive(Debug)]
struct Layer {
    color: Vec3,
    cones: Vec<Cone>,
}

impl View {
    /// The pose is one above the ground.
    pub(crate) fn new(world: &World, pose: CameraPose) -> Self {
        let position = pose.position_in_world();
        let camera_from_world: DMat3 = pose.rotation_world_from_camera().transpose();
        let cone = |shape| Cone::new(&shape, position, camera_from_world);
        let seen = world.layers_seen_from(position).into_iter().map(|layer| Layer {
            color: layer.color,
            cones: layer.shapes.into_iter().filter_map(cone).collect(),
        });
        Self { background: world.background(), layers: seen.collect() }
    }

    /// Mean linear colour over a patch. Where edges cross it, it is cut into `parts_per_side` × `parts_per_side`.
    pub(crate) fn color(&self, patch: RayPatch, parts_per_side: u16) -> Vec3 {
        self.even_color(&patch).unwrap_or_else(|| {
            let sum: Vec3 = patch.parts(parts_per_side).map(|part| self.blended_color(&part)).sum();
            sum / f32::from(parts_per_side).powi(2)
        })
    }

    /// The colour of a patch that no edge crosses.
    fn even_color(&self, patch: &RayPatch) -> Option<Vec3> {
        let mut color = self.background;
        for layer in &self.layers {
            match layer.side(patch) {
                Side::Outside => {}
                Side::Inside => color = layer.color,
                Side::Edge => return None,
            }
        }
        Some(color)
    }

    /// Each layer hides the part of the patch that it covers.
    fn blended_color(&self, patch: &RayPatch) -> Vec3 {
        self.layers.iter().fold(self.background, |color, layer| color.lerp(layer.color, layer.coverage(patch)))
    }
}

impl Layer {
    fn side(&self, patch: &RayPatch) -> Side {
        let mut side = Side::Outside;
        for cone in &self.cones {
            match cone.side(patch) {
                Side::Outside => {}
                Side::Inside => return Side::Inside,
                Side::Edge => side = Side::Edge,
            }
        }
        side
    }

    /// Lines overlap where they meet, edge on edge: what the widest of them covers is all that is covered.
    fn coverage(&self, patch: &RayPatch) -> f32 {
        self.cones.iter().fold(0.0, |most, cone| cone.coverage(patch).max(most))
    }
}
