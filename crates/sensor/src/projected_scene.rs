//! The scene as a camera sees it from a pose, and the fraction of a pixel that each shape covers.
//!
//! A shape with straight edges occupies the rays between planes through the projection centre. A ray's position relative to
//! such a plane is linear in the ray, so that the covered fraction of a pixel has a closed form, however far away or thin
//! the shape is.

mod polygon;
mod ring;
mod side;

use glam::{DMat3, DVec2, DVec3, Vec3};
use reality_sim_core::pose::CameraPose;

use self::{polygon::Polygon, ring::Ring, side::Side};
use crate::{
    lens::RayPatch,
    scene::{Overlap, Scene, Shape},
};

/// Scene as a camera sees it from a pose.
#[derive(Debug)]
pub(crate) struct ProjectedScene {
    position_in_world: DVec3,
    camera_from_world: DMat3,
    background: Vec3,
    /// Layers from back to front.
    layers: Vec<ProjectedLayer>,
}

/// Visible shapes of one colour.
#[derive(Debug)]
struct ProjectedLayer {
    color: Vec3,
    cones: Vec<Cone>,
    overlap: Overlap,
    on_ground: bool,
}

/// Rays in which a shape is visible.
#[derive(Debug)]
enum Cone {
    Polygon(Polygon),
    Ring(Ring),
}

impl ProjectedScene {
    /// Projects the scene to a camera pose above the ground.
    pub(crate) fn new(scene: &Scene, pose: CameraPose) -> Self {
        let position = pose.position_in_world();
        let camera_from_world = pose.rotation_world_from_camera().transpose();
        let cone = |shape| Cone::new(&shape, position, camera_from_world);
        let seen = scene.layers_seen_from(position).into_iter().map(|layer| ProjectedLayer {
            color: layer.color,
            cones: layer.shapes.into_iter().filter_map(cone).collect(),
            overlap: layer.overlap,
            on_ground: layer.on_ground,
        });
        let layers = seen.collect();
        Self { position_in_world: position, camera_from_world, background: scene.background(), layers }
    }

    /// Returns the point in metres where a ray meets the ground plane; `None` if it does not.
    pub(crate) fn ground(&self, ray: Vec3) -> Option<DVec2> {
        let ray_in_world = self.camera_from_world.transpose() * ray.as_dvec3();
        let length = -self.position_in_world.z / ray_in_world.z;
        (ray_in_world.z < 0.0).then(|| (self.position_in_world + length * ray_in_world).truncate())
    }

    /// Returns the mean linear colour over a patch; the colours of layers on the ground are multiplied by `light`. A patch
    /// that edges cross is cut into `parts_per_side` × `parts_per_side`.
    pub(crate) fn color(&self, patch: RayPatch, parts_per_side: u16, light: f32) -> Vec3 {
        self.even_color(&patch, light).unwrap_or_else(|| {
            let sum: Vec3 = patch.parts(parts_per_side).map(|part| self.blended_color(&part, light)).sum();
            sum / f32::from(parts_per_side).powi(2)
        })
    }

    /// Returns the foremost layer's colour for a patch that no visible edge crosses.
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

    /// Blends the layers from back to front by the fraction of the patch that each covers.
    fn blended_color(&self, patch: &RayPatch, light: f32) -> Vec3 {
        self.layers
            .iter()
            .fold(self.background, |color, layer| color.lerp(layer.lit(light), layer.coverage(patch)))
    }
}

impl ProjectedLayer {
    /// Returns the colour under this light on the ground.
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
    /// Computes the rays of a shape; `None` for a shape without area.
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
