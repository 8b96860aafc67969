//! The world as rays from a camera, and how much of a pixel each shape covers.
//!
//! A shape with straight edges is seen in the rays between planes through the projection centre. Where a ray lies to
//! such a plane is linear in the ray: the part of a pixel that it covers is found in closed form, however far the
//! shape and however thin.

mod polygon;
mod ring;
mod side;

use glam::{DMat3, DVec2, DVec3, Vec3};
use reality_sim_core::pose::CameraPose;

use self::{polygon::Polygon, ring::Ring, side::Side};
use crate::{
    lens::RayPatch,
    world::{Overlap, Shape, World},
};

/// What a camera sees at a pose.
#[derive(Debug)]
pub(crate) struct View {
    position_in_world: DVec3,
    camera_from_world: DMat3,
    background: Vec3,
    /// Each hides those before it.
    layers: Vec<Layer>,
}

/// What is seen of one colour.
#[derive(Debug)]
struct Layer {
    color: Vec3,
    cones: Vec<Cone>,
    overlap: Overlap,
    on_ground: bool,
}

/// The rays in which a shape is seen.
#[derive(Debug)]
enum Cone {
    Polygon(Polygon),
    Ring(Ring),
}

impl View {
    /// The pose is one above the ground.
    pub(crate) fn new(world: &World, pose: CameraPose) -> Self {
        let position = pose.position_in_world();
        let camera_from_world = pose.rotation_world_from_camera().transpose();
        let cone = |shape| Cone::new(&shape, position, camera_from_world);
        let seen = world.layers_seen_from(position).into_iter().map(|layer| Layer {
            color: layer.color,
            cones: layer.shapes.into_iter().filter_map(cone).collect(),
            overlap: layer.overlap,
            on_ground: layer.on_ground,
        });
        let layers = seen.collect();
        Self { position_in_world: position, camera_from_world, background: world.background(), layers }
    }

    /// The point of the ground plane, metres, that a ray meets; `None` for one that does not.
    pub(crate) fn ground(&self, ray: Vec3) -> Option<DVec2> {
        let ray_in_world = self.camera_from_world.transpose() * ray.as_dvec3();
        let length = -self.position_in_world.z / ray_in_world.z;
        (ray_in_world.z < 0.0).then(|| (self.position_in_world + length * ray_in_world).truncate())
    }

    /// Mean linear colour over a patch; what lies on the ground is `light` times as bright. Where edges cross the patch,
    /// it is cut into `parts_per_side` × `parts_per_side`.
    pub(crate) fn color(&self, patch: RayPatch, parts_per_side: u16, light: f32) -> Vec3 {
        self.even_color(&patch, light).unwrap_or_else(|| {
            let sum: Vec3 = patch.parts(parts_per_side).map(|part| self.blended_color(&part, light)).sum();
            sum / f32::from(parts_per_side).powi(2)
        })
    }

    /// The colour of a patch that no visible edge crosses: that of the foremost layer.
    fn even_color(&self, patch: &RayPatch, light: f32) -> Option<Vec3> {
        for layer in self.layers.iter().rev() {
            match layer.side(patch) {
                Side::Outside => {}
                Side::Inside => return Some(layer.lit(light)),
                Side::Edge => return None,
            }
        }
        Some(self.background)
    }

    /// Each layer hides the part of the patch that it covers.
    fn blended_color(&self, patch: &RayPatch, light: f32) -> Vec3 {
        self.layers
            .iter()
            .fold(self.background, |color, layer| color.lerp(layer.lit(light), layer.coverage(patch)))
    }
}

impl Layer {
    /// The colour where the light on the ground is this much.
    fn lit(&self, light: f32) -> Vec3 {
        if self.on_ground { light * self.color } else { self.color }
    }

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

    fn coverage(&self, patch: &RayPatch) -> f32 {
        let each = self.cones.iter().map(|cone| cone.coverage(patch));
        match self.overlap {
            Overlap::None => each.sum::<f32>().min(1.0),
            Overlap::Joined => each.fold(0.0, f32::max),
        }
    }
}

impl Cone {
    /// `None` for a shape without area.
    fn new(shape: &Shape, position: DVec3, camera_from_world: DMat3) -> Option<Self> {
        match shape {
            Shape::Polygon(corners) => Polygon::new(corners, position, camera_from_world).map(Self::Polygon),
            Shape::Ring { center, inner_m, outer_m } => {
                Ring::new(*center, [*inner_m, *outer_m], position, camera_from_world).map(Self::Ring)
            }
        }
    }

    fn side(&self, patch: &RayPatch) -> Side {
        match self {
            Self::Polygon(polygon) => polygon.side(patch),
            Self::Ring(ring) => ring.side(patch),
        }
    }

    fn coverage(&self, patch: &RayPatch) -> f32 {
        match self {
            Self::Polygon(polygon) => polygon.coverage(patch),
            Self::Ring(ring) => ring.coverage(patch),
        }
    }
}
