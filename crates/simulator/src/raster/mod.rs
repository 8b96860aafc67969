//! Rasteriser: a mesh in the world, drawn through the true lens as fragments of pixels.

mod clip;
mod fill;
mod screen;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use self::{
    clip::Clipper,
    fill::fill,
    screen::{Corner, ScreenTriangle},
};
use crate::{canvas::Canvas, mesh::Mesh, pixel_box::PixelBox, shading::Shading, view::View};

/// Where a mesh is while a picture is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Motion of points from the mesh's frame to the world, in the middle of the exposure, metres.
    pub world_from_mesh: DAffine3,
    /// Velocity, metres per second.
    pub velocity_in_world: DVec3,
}

impl Placed {
    /// Places a mesh that stands still.
    pub fn still(world_from_mesh: DAffine3) -> Self {
        Self { world_from_mesh, velocity_in_world: DVec3::ZERO }
    }
}

/// Draws a mesh as an object of a layer. Parts that the lens does not see are left out, as is a mesh without
/// triangles or at a place that is not finite.
pub fn draw_mesh(
    view: &View<'_>,
    canvas: &mut Canvas,
    mesh: &Mesh,
    placed: &Placed,
    shading: &Shading<'_>,
    object: u16,
) {
    let Some((middle, radius_m)) = mesh.bounds() else { return };
    if !placed.world_from_mesh.is_finite()
        || !placed.velocity_in_world.is_finite()
        || mesh.triangles.is_empty()
    {
        return;
    }
    let position = view.pose().position_in_world();
    let middle = placed.world_from_mesh.transform_point3(middle);
    let matrix = placed.world_from_mesh.matrix3;
    let radius_m = radius_m * matrix.x_axis.length().max(matrix.y_axis.length()).max(matrix.z_axis.length());
    let distance_m = middle.distance(position);
    if is_beyond_lens(view, middle - position, radius_m) {
        canvas.add_extent(object, 0.0, 1.0);
        return;
    }
    let world = World::new(mesh, placed, shading, position);
    for instant in view.instants(placed.velocity_in_world, (distance_m - radius_m).max(0.1 * radius_m)) {
        let clipper = Clipper { view, instant, velocity: placed.velocity_in_world };
        let triangles = world.on_screen(&clipper, position);
        canvas.open(area(&triangles, view.size()));
        tell_extent(&triangles, view.size(), canvas, object);
        for triangle in &triangles {
            fill(canvas, triangle, object, instant.parts);
        }
    }
}

/// Whether a sphere lies beyond the lens's largest valid angle.
fn is_beyond_lens(view: &View<'_>, from_camera: DVec3, radius_m: f64) -> bool {
    let distance_m = from_camera.length();
    let forward = view.world_from_camera.z_axis;
    let angle_rad = forward.angle_between(from_camera);
    distance_m > radius_m && angle_rad - (radius_m / distance_m).asin() > view.lens().max_angle_rad()
}

/// Mesh in the world with its colours.
struct World<'a> {
    places: Vec<DVec3>,
    colors: Vec<Vec3>,
    triangles: &'a [[u32; 3]],
    /// Whether the motion turns the mesh inside out.
    is_mirrored: bool,
}

impl<'a> World<'a> {
    fn new(mesh: &'a Mesh, placed: &Placed, shading: &Shading<'_>, camera: DVec3) -> Self {
        let matrix = placed.world_from_mesh.matrix3;
        let turn: DMat3 =
            if matrix.determinant() == 0.0 { DMat3::ZERO } else { matrix.inverse().transpose() };
        let place = |place: Vec3| placed.world_from_mesh.transform_point3(place.as_dvec3());
        let normal = |normal: Vec3| (turn * normal.as_dvec3()).normalize_or_zero().as_vec3();
        Self {
            places: mesh.vertices.iter().map(|vertex| place(vertex.place)).collect(),
            colors: mesh
                .vertices
                .iter()
                .map(|v| shading.color(place(v.place), normal(v.normal), v.reflectance, camera))
                .collect(),
            triangles: &mesh.triangles,
            is_mirrored: matrix.determinant() < 0.0,
        }
    }

    /// Projects the triangles that face the camera.
    fn on_screen(&self, clipper: &Clipper<'_>, position: DVec3) -> Vec<ScreenTriangle> {
        let mut corners: Vec<Option<Corner>> = vec![None; self.places.len()];
        let mut is_projected = vec![false; self.places.len()];
        let mut triangles = Vec::with_capacity(self.triangles.len() / 2);
        for indices in self.triangles {
            let indices = indices.map(|index| index as usize);
            if indices.iter().any(|index| *index >= self.places.len()) || !self.faces(indices, position) {
                continue;
            }
            for index in indices {
                if !is_projected[index] {
                    corners[index] = clipper.corner(self.places[index], self.colors[index]);
                    is_projected[index] = true;
                }
            }
            let corner = |index: usize| (self.places[index], self.colors[index], corners[index]);
            clipper.put(indices.map(corner), &mut triangles);
        }
        triangles
    }

    fn faces(&self, [a, b, c]: [usize; 3], position: DVec3) -> bool {
        let normal = (self.places[b] - self.places[a]).cross(self.places[c] - self.places[a]);
        let towards = normal.dot(position - self.places[a]);
        if self.is_mirrored { towards < 0.0 } else { towards > 0.0 }
    }
}

/// Returns the pixels that triangles may touch.
fn area(triangles: &[ScreenTriangle], size: [u32; 2]) -> PixelBox {
    let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for corner in triangles.iter().flat_map(|triangle| &triangle.corners) {
        for axis in 0..2 {
            least[axis] = least[axis].min(corner.pixel[axis]);
            most[axis] = most[axis].max(corner.pixel[axis]);
        }
    }
    PixelBox::touched(least, most, size).unwrap_or_default()
}

/// Tells a canvas how much of an object lies in and outside the picture: triangles by their middles.
fn tell_extent(triangles: &[ScreenTriangle], size: [u32; 2], canvas: &mut Canvas, object: u16) {
    let (mut inside, mut outside) = (0.0, 0.0);
    for triangle in triangles {
        let middle = triangle.middle();
        let is_inside = (0..2).all(|axis| middle[axis] >= -0.5 && middle[axis] < f64::from(size[axis]) - 0.5);
        *if is_inside { &mut inside } else { &mut outside } += triangle.area_px2();
    }
    canvas.add_extent(object, inside as f32, outside as f32);
}

#[cfg(test)]
mod tests;
