//! A ball.

use std::{borrow::Cow, sync::LazyLock};

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::{
    canvas::Canvas,
    class::Class,
    layer::{Layer, Object, Sphere},
    mesh::Mesh,
    raster::{Placed, draw_mesh},
    shading::Shading,
    view::View,
};

/// Numbers of cuts of the icosahedron, each with the radius in the picture up to which it is used, pixels: straight edges are
/// then at most 0.05 pixels beside the circle (1 − cos of half an edge's angle, of 9.0°, 4.5° and 2.2°).
const DETAILS: [(u32, f64); 3] = [(3, 15.0), (4, 62.0), (5, f64::INFINITY)];

/// Spheres of radius 1, one for each of [`DETAILS`], white.
static SPHERES: LazyLock<[Mesh; 3]> =
    LazyLock::new(|| DETAILS.map(|(cuts, _)| Mesh::sphere(cuts, Vec3::ONE)));

/// Ball of one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Ball {
    /// Name by which the simulator knows it.
    pub name: String,
    /// Centre, metres.
    pub center_in_world: DVec3,
    /// Radius, metres.
    pub radius_m: f64,
    /// Reflectance in red, green and blue, linear, 0 to 1.
    pub reflectance: Vec3,
    /// Share of the light from above that its surface mirrors: 0 for a matt ball.
    pub gloss: f32,
    /// Velocity, metres per second.
    pub velocity_in_world: DVec3,
}

impl Ball {
    /// Makes a ball that lies on the ground.
    pub fn on_ground(x_m: f64, y_m: f64, radius_m: f64, reflectance: Vec3) -> Self {
        Self {
            name: "ball".to_owned(),
            center_in_world: DVec3::new(x_m, y_m, radius_m),
            radius_m,
            reflectance,
            gloss: 0.0,
            velocity_in_world: DVec3::ZERO,
        }
    }

    /// Gives the ball a name.
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Lets the ball's surface mirror a share of the light from above.
    pub fn glossy(self, gloss: f32) -> Self {
        Self { gloss, ..self }
    }

    /// Lets the ball move, metres per second.
    pub fn moving(self, velocity_in_world: DVec3) -> Self {
        Self { velocity_in_world, ..self }
    }

    fn is_drawable(&self) -> bool {
        self.center_in_world.is_finite() && self.radius_m.is_finite() && self.radius_m > 0.0
    }
}

impl Layer for Ball {
    fn objects(&self) -> Vec<Object<'_>> {
        vec![Object { class: Class::Ball, name: Cow::Borrowed(&self.name) }]
    }

    fn draw(&self, view: &View<'_>, canvas: &mut Canvas) {
        let distance_m = self.center_in_world.distance(view.pose().position_in_world());
        if !self.is_drawable() || distance_m <= self.radius_m {
            return;
        }
        let radius_px = view.lens().fx.max(view.lens().fy) * self.radius_m / (distance_m - self.radius_m);
        let detail =
            DETAILS.iter().position(|(_, most_px)| radius_px <= *most_px).unwrap_or(DETAILS.len() - 1);
        let size = DMat3::from_diagonal(DVec3::splat(self.radius_m));
        let placed = Placed {
            world_from_mesh: DAffine3::from_mat3_translation(size, self.center_in_world),
            velocity_in_world: self.velocity_in_world,
        };
        let light = view.light_at(self.center_in_world.truncate());
        let occluders = self.occluders();
        let shading =
            Shading { light, reflectance: self.reflectance, gloss: self.gloss, occluders: &occluders };
        draw_mesh(view, canvas, &SPHERES[detail], &placed, &shading, 0);
    }

    fn occluders(&self) -> Vec<Sphere> {
        if !self.is_drawable() {
            return Vec::new();
        }
        vec![Sphere { center_in_world: self.center_in_world, radius_m: self.radius_m }]
    }
}
