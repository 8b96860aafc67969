//! Loops over pixels: a pixel's ray is followed to the proxy geometry, and the point found there is projected into
//! another picture, whose colour is read.
//!
//! Sixteen pixels are handled at a time, in plain arrays that the compiler turns into vector instructions. The compute
//! shader of the same name does the same, with one pixel per thread.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use super::{Billboard, Picture, ProxyGeometry, rays::RayBlock};
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

/// Edges of a billboard, metres.
struct Edges {
    half_width: f32,
    top: f32,
    opening_half_width: f32,
    opening_top: f32,
}

impl Edges {
    #[inline(always)]
    fn new(billboard: &Billboard) -> Self {
        Self {
            half_width: billboard.half_width_m as f32,
            top: billboard.height_m as f32,
            opening_half_width: billboard.opening_half_width_m as f32,
            opening_top: billboard.opening_height_m as f32,
        }
    }

    /// Returns whether a point in the billboard's plane, above the ground, lies on it or at most `margin` beside it,
    /// metres.
    #[inline(always)]
    fn hold(&self, across: f32, up: f32, margin: f32) -> bool {
        let across = across.abs();
        let is_opening = (across < self.opening_half_width - margin) & (up < self.opening_top - margin);
        (across <= self.half_width + margin) & (up <= self.top + margin) & !is_opening
    }
}

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
}

/// Follows rays from a camera inside the proxy geometry.
#[inline(always)]
pub(crate) fn proxy_points(proxy: &ProxyGeometry, from: &Placement, rays: &RayBlock) -> ProxyPoints {
    let axes = &from.axes_in_world;
    let mut direction = [[0.0_f32; LANES]; 3];
    let mut distance = [f32::INFINITY; LANES];
    let mut on_ground = [0.0_f32; LANES];
    for axis in 0..3 {
        let low = proxy.min_in_world[axis] as f32 - from.position_in_world[axis];
        let high = proxy.max_in_world[axis] as f32 - from.position_in_world[axis];
        for i in 0..LANES {
            let d = axes[0][axis] * rays[0][i] + axes[1][axis] * rays[1][i] + axes[2][axis] * rays[2][i];
            direction[axis][i] = d;
            let end = if d < 0.0 { low } else { high };
            let to_wall = end / d;
            let is_nearer = to_wall < distance[i];
            distance[i] = if is_nearer { to_wall } else { distance[i] };
            if axis == 2 {
                on_ground[i] = if is_nearer & (d < 0.0) { 1.0 } else { 0.0 };
            }
        }
    }
    for billboard in &proxy.billboards {
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
            on_ground[i] = if is_hit { 0.0 } else { on_ground[i] };
        }
    }
    let mut place = [[0.0_f32; LANES]; 3];
    for axis in 0..3 {
        for i in 0..LANES {
            place[axis][i] = from.position_in_world[axis] + distance[i] * direction[axis][i];
        }
    }
    ProxyPoints { place, direction, distance, on_ground }
}

/// Projects the points into another camera; `None` if it sees none of them.
#[inline(always)]
pub(crate) fn see(camera: &KernelCamera, placement: &Placement, points: &ProxyPoints) -> Option<Pixels> {
    let mut in_camera = [[0.0_f32; LANES]; 3];
    let [x, y, z] = placement.position_in_world;
    for axis in 0..3 {
        let [a, b, c] = placement.axes_in_world[axis];
        for i in 0..LANES {
            in_camera[axis][i] =
                a * (points.place[0][i] - x) + b * (points.place[1][i] - y) + c * (points.place[2][i] - z);
        }
    }
    project_lanes(camera, &in_camera)
}

/// Returns 0 for points hidden from a camera by a goal, else 1.
#[inline(always)]
pub(crate) fn unhidden(proxy: &ProxyGeometry, from: &Placement, points: &ProxyPoints) -> Lanes {
    /// Fraction of the way to a point beyond which a billboard does not hide it: a point on the billboard is not hidden
    /// by it.
    const ON_SCREEN: f32 = 1.0 - 1e-3;
    /// Radius of a typical post. Seen obliquely, a round post hides more than the flat one that stands for it, by
    /// an amount that grows with one over the cosine.
    const POST_RADIUS_M: f32 = 0.05;
    /// Less than 1, since pixels and compression spread a post's colour beyond its edge.
    const SHARP_EDGE: f32 = 0.6;
    /// Maximum of one over the cosine: seen nearly edge-on, a billboard would hide everything.
    const MOST_OBLIQUE: f32 = 4.0;
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
            let slope = dy / dx;
            let margin = POST_RADIUS_M * ((1.0 + slope * slope).sqrt().min(MOST_OBLIQUE) - SHARP_EDGE);
            let is_hidden = is_between & billboard.hold(across, up, margin);
            unhidden[i] = if is_hidden { 0.0 } else { unhidden[i] };
        }
    }
    unhidden
}

/// Colours at sixteen pixels.
pub(crate) struct Samples {
    /// Red, green and blue, 0–255.
    pub color: [Lanes; 3],
    /// 1 where the scene is shown, 0 where the picture's mask hides it.
    pub shown: Lanes,
}

/// Returns bilinear colours; values at points that are not seen are meaningless.
#[inline(always)]
pub(crate) fn sample(picture: &Picture, pixels: &Pixels) -> Samples {
    let mut index = [0usize; LANES];
    let (mut fu, mut fv) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    let (last_u, last_v) = ((picture.width.max(2) - 2) as f32, (picture.height.max(2) - 2) as f32);
    for i in 0..LANES {
        // `clamp` keeps NaN, `max` does not.
        let (u, v) = (pixels.u[i].max(0.0).min(last_u + 1.0), pixels.v[i].max(0.0).min(last_v + 1.0));
        let (column, row) = (u.min(last_u) as i32 as f32, v.min(last_v) as i32 as f32);
        fu[i] = u - column;
        fv[i] = v - row;
        index[i] = (row as i32 * picture.width as i32 + column as i32) as usize;
    }
    let mut texels = [[0u32; LANES]; 4];
    let width = picture.width as usize;
    for i in 0..LANES {
        // A picture of one column or row has no second one.
        if let (Some([a, b, ..]), Some([c, d, ..])) =
            (picture.pixels.get(index[i]..), picture.pixels.get(index[i] + width..))
        {
            (texels[0][i], texels[1][i], texels[2][i], texels[3][i]) = (*a, *b, *c, *d);
        }
    }
    let mut color = [[0.0_f32; LANES]; 3];
    let mut shown = [0.0_f32; LANES];
    for i in 0..LANES {
        let least = texels[0][i] & texels[1][i] & texels[2][i] & texels[3][i];
        shown[i] = f32::from(u8::from(least >> 24 == u32::from(Picture::SHOWN)));
    }
    for channel in 0..3 {
        let shift = 8 * channel as u32;
        for i in 0..LANES {
            let at = |tap: usize| (texels[tap][i] >> shift & 255) as f32;
            let top = at(0) + fu[i] * (at(1) - at(0));
            let bottom = at(2) + fu[i] * (at(3) - at(2));
            color[channel][i] = top + fv[i] * (bottom - top);
        }
    }
    Samples { color, shown }
}
