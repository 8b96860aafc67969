//! What a simulator adds to the recorded picture.

use std::{borrow::Cow, fmt::Debug};

use glam::DVec3;

use crate::{canvas::Canvas, class::Class, view::View};

/// Something that a camera draws over the recorded scene: a ball, robots, or whatever a simulator renders itself. All layers of
/// a picture are composed by depth with each other and with the scene, and then go through the camera.
pub trait Layer: Send + Sync + Debug {
    /// Returns what the layer consists of, for labels. [`Canvas::put`] tells its objects apart by their places in this list.
    fn objects(&self) -> Vec<Object<'_>>;

    /// Draws the layer: the light that it sends to the camera, before lens and sensor. The canvas is empty, and has no other
    /// layer's samples.
    fn draw(&self, view: &View<'_>, canvas: &mut Canvas);

    /// Returns spheres that stand for the layer where it takes light from the ground; none cast no shadow.
    fn occluders(&self) -> Vec<Sphere> {
        Vec::new()
    }
}

/// Object of a layer, as labels name it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object<'a> {
    /// Class of its pixels.
    pub class: Class,
    /// Name by which the simulator knows it.
    pub name: Cow<'a, str>,
}

/// Sphere in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Centre, metres.
    pub center_in_world: DVec3,
    /// Radius, metres.
    pub radius_m: f64,
}
