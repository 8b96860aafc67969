//! A mesh of the simulator's own.

use std::{borrow::Cow, sync::Arc};

use crate::{
    canvas::Canvas,
    class::Class,
    layer::{Layer, Object, Sphere},
    mesh::Mesh,
    raster::{Placed, draw_mesh},
    shading::Shading,
    view::View,
};

/// Mesh at a place in the world.
#[derive(Debug, Clone)]
pub struct Body {
    /// Class of its pixels.
    pub class: Class,
    /// Name by which the simulator knows it.
    pub name: String,
    /// Surface.
    pub mesh: Arc<Mesh>,
    /// Where it is.
    pub placed: Placed,
    /// Spheres that stand for it where it takes light from the ground; none cast no shadow.
    pub occluders: Vec<Sphere>,
}

impl Layer for Body {
    fn objects(&self) -> Vec<Object<'_>> {
        vec![Object { class: self.class, name: Cow::Borrowed(&self.name) }]
    }

    fn draw(&self, view: &View<'_>, canvas: &mut Canvas) {
        let light = view.light_at(self.placed.world_from_mesh.translation.truncate());
        let shading = Shading { occluders: &self.occluders, ..Shading::matt(light) };
        draw_mesh(view, canvas, &self.mesh, &self.placed, &shading, 0);
    }

    fn occluders(&self) -> Vec<Sphere> {
        self.occluders.clone()
    }
}
