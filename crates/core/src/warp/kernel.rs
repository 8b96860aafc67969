//! Loops over pixels: a pixel's ray is followed to the proxy geometry, and the point found there is projected into
//! another picture, whose colour is read.
//!
//! Sixteen pixels are handled at a time, in plain arrays that the compiler turns into vector instructions. The compute
//! shader of the same name does the same, with one pixel per thread.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use super::{
    ProxyGeometry,
    edges::{Edges, post_margin},
    rays::RayBlock,
};
use crate::{
    camera::{KernelCamera, LANES, Lanes, Pixels, project_lanes},
    pose::CameraPose,
};

/// Pose in single precision: `camera = rows · (world − position)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Right, down and forward axes of the camera in the world.
    pub axes_in_world: [[f32; 3]; 3],
    /// Projection centre, metres.
    pub position_in_world: [f32; 3],
}

impl Placement {
    /// Converts a pose to single precision.
    pub fn new(pose: CameraPose) -> Self {
        let rotation = pose.rotation_world_from_camera();
        let axes = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
        Self {
            axes_in_world: axes.map(|axis| axis.as_vec3().to_array()),
            position_in_world: pose.position_in_world().as_vec3().to_array(),
        }
    }
}

/// Number of the ground among the surfaces: the lower end of the third axis.
pub(crate) const GROUND: f32 = 2.0;
/// Number of the ceiling: the upper end of the third axis.
pub(crate) const CEILING: f32 = 5.0;
/// Number of the first billboard among the surfaces.
pub(crate) const FIRST_BILLBOARD: usize = 6;

/// Points of the proxy geometry that sixteen pixels see.
#[derive(Clone, Copy)]
pub(crate) struct ProxyPoints {
    /// Coordinates in the world, metres.
    pub place: [Lanes; 3],
    /// Unit directions from the camera, world axes.
    pub direction: [Lanes; 3],
    /// Distances from the camera, metres.
    pub distance: Lanes,
    /// 1 on the ground, else 0.
    pub on_ground: Lanes,
    /// Surfaces on which the points lie: a number for each side of the box and for each billboard.
    pub surface: Lanes,
}

/// Follows rays from a camera inside the proxy geometry.
#[inline(always)]
pub(crate) fn proxy_points(proxy: &ProxyGeometry, from: &Placement, rays: &RayBlock) -> ProxyPoints {
    let direction = directions(from, rays);
    let mut distance = [f32::INFINITY; LANES];
    let mut surface = [f32::NAN; LANES];
    for axis in 0..3 {
        let low = proxy.min_in_world[axis] as f32 - from.position_in_world[axis];
        let high = proxy.max_in_world[axis] as f32 - from.position_in_world[axis];
        for i in 0..LANES {
            let d = direction[axis][i];
            let end = if d < 0.0 { low } else { high };
            let to_wall = end / d;
            let is_nearer = to_wall < distance[i];
            distance[i] = if is_nearer { to_wall } else { distance[i] };
            let side = if d < 0.0 { axis as f32 } else { (axis + 3) as f32 };
            surface[i] = if is_nearer { side } else { surface[i] };
        }
    }
    for (number, billboard) in proxy.billboards.iter().enumerate() {
        let x = billboard.x_m as f32 - from.position_in_world[0];
        if !direction[0].iter().any(|d| d * x > 0.0) {
            continue;
        }
        let billboard = Edges::new(billboard);
        for i in 0..LANES {
            let to_billboard = x / direction[0][i];
            let y = from.position_in_world[1] + to_billboard * direction[1][i];
            let z = from.position_in_world[2] + to_billboard * direction[2][i];
            let is_hit =
                (to_billboard > 0.0) & (to_billboard < distance[i]) & (z >= 0.0) & billboard.hold(y, z, 0.0);
            distance[i] = if is_hit { to_billboard } else { distance[i] };
            surface[i] = if is_hit { (FIRST_BILLBOARD + number) as f32 } else { surface[i] };
        }
    }
    let mut place = [[0.0_f32; LANES]; 3];
    for axis in 0..3 {
        for i in 0..LANES {
            place[axis][i] = from.position_in_world[axis] + distance[i] * direction[axis][i];
        }
    }
    let mut on_ground = [0.0_f32; LANES];
    for i in 0..LANES {
        on_ground[i] = if surface[i] == GROUND { 1.0 } else { 0.0 };
    }
    ProxyPoints { place, direction, distance, on_ground, surface }
}

/// Returns the directions of rays, world axes.
#[inline(always)]
pub(crate) fn directions(from: &Placement, rays: &RayBlock) -> [Lanes; 3] {
    let axes = &from.axes_in_world;
    let mut direction = [[0.0_f32; LANES]; 3];
    for axis in 0..3 {
        for i in 0..LANES {
            direction[axis][i] =
                axes[0][axis] * rays[0][i] + axes[1][axis] * rays[1][i] + axes[2][axis] * rays[2][i];
        }
    }
    direction
}

/// Projects the points into another camera; `None` if it sees none of them.
#[inline(always)]
pub(crate) fn see(camera: &KernelCamera, placement: &Placement, points: &ProxyPoints) -> Option<Pixels> {
    project_lanes(camera, &in_camera(placement, points))
}

/// Returns the points in the axes of another camera, metres.
#[inline(always)]
pub(crate) fn in_camera(placement: &Placement, points: &ProxyPoints) -> [Lanes; 3] {
    let mut in_camera = [[0.0_f32; LANES]; 3];
    let [x, y, z] = placement.position_in_world;
    for axis in 0..3 {
        let [a, b, c] = placement.axes_in_world[axis];
        for i in 0..LANES {
            in_camera[axis][i] =
                a * (points.place[0][i] - x) + b * (points.place[1][i] - y) + c * (points.place[2][i] - z);
        }
    }
    in_camera
}

/// Fraction of the way to a point beyond which a billboard does not hide it: a point on the billboard is not hidden by it.
pub(crate) const ON_SCREEN: f32 = 1.0 - 1e-3;

/// Returns 0 for points hidden from a camera by a goal, else 1.
#[inline(always)]
pub(crate) fn unhidden(proxy: &ProxyGeometry, from: &Placement, points: &ProxyPoints) -> Lanes {
    let [x, y, z] = from.position_in_world;
    let mut unhidden = [1.0_f32; LANES];
    // Both minimum and maximum ignore NaN.
    let least_x = points.place[0].iter().fold(x, |least, place| least.min(*place));
    let most_x = points.place[0].iter().fold(x, |most, place| most.max(*place));
    for billboard in &proxy.billboards {
        let to_billboard = billboard.x_m as f32 - x;
        // Most billboards stand behind the camera, or behind all of the points.
        if !(least_x..=most_x).contains(&(billboard.x_m as f32)) {
            continue;
        }
        let billboard = Edges::new(billboard);
        for i in 0..LANES {
            let (dx, dy) = (points.place[0][i] - x, points.place[1][i] - y);
            let share = to_billboard / dx;
            let across = y + share * dy;
            let up = z + share * (points.place[2][i] - z);
            let is_between = (share > 0.0) & (share < ON_SCREEN);
            let is_hidden = is_between & billboard.hold(across, up, post_margin(dy / dx));
            unhidden[i] = if is_hidden { 0.0 } else { unhidden[i] };
        }
    }
    unhidden
}
