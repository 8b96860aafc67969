//! A goal as a camera sees it: posts and crossbar as the cylinders that they are, its back as the screen of the proxy geometry.

use glam::DVec3;
use reality_sim_core::{
    camera::{LANES, Lanes},
    field::Goal,
    warp::Billboard,
};

/// Goal in world axes, with the camera as the origin, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct GoalView {
    posts: [[f32; 2]; 2],
    radius: f32,
    top: f32,
    foot: f32,
    /// Axis of the crossbar: x, z.
    bar: [f32; 2],
    /// Ends of the crossbar, y.
    bar_ends: [f32; 2],
    back: Back,
}

/// Screen behind the posts.
#[derive(Debug, Clone, Copy)]
struct Back {
    x: f32,
    sides: [f32; 2],
    top: f32,
}

impl GoalView {
    /// Places a goal and its back before a camera.
    pub(super) fn new(goal: &Goal, back: &Billboard, camera_in_world: DVec3) -> Self {
        let [a, b] = goal.posts.map(|post| (post.center - camera_in_world.truncate()).as_vec2().to_array());
        let (radius, post_top) = (goal.posts[0].radius_m, goal.posts[0].height_m);
        let from_camera = |z_m: f64| (z_m - camera_in_world.z) as f32;
        let side = |y_m: f64| (y_m - camera_in_world.y) as f32;
        Self {
            posts: [a, b],
            radius: radius as f32,
            top: from_camera(post_top),
            foot: from_camera(0.0),
            bar: [a[0], from_camera(post_top - radius)],
            bar_ends: [a[1].min(b[1]), a[1].max(b[1])],
            back: Back {
                x: (back.x_m - camera_in_world.x) as f32,
                sides: [side(-back.half_width_m), side(back.half_width_m)],
                top: from_camera(back.height_m),
            },
        }
    }

    /// Returns 1 for the rays that may meet the goal, else 0: all those that do, and few others. `inverse_x` is one over the
    /// directions' x.
    #[inline(always)]
    pub(super) fn candidates(&self, direction: &[Lanes; 3], inverse_x: &Lanes) -> [u32; LANES] {
        let mut found = [0_u32; LANES];
        let square = self.radius * self.radius;
        let [x, y, z] = direction;
        for [px, py] in self.posts {
            for i in 0..LANES {
                let cross = px * y[i] - py * x[i];
                let is_near = cross * cross <= square * (x[i] * x[i] + y[i] * y[i]);
                found[i] |= u32::from(is_near & (px * x[i] + py * y[i] > 0.0));
            }
        }
        let [bx, bz] = self.bar;
        for i in 0..LANES {
            let cross = bx * z[i] - bz * x[i];
            let is_near = cross * cross <= square * (x[i] * x[i] + z[i] * z[i]);
            found[i] |= u32::from(is_near & (bx * x[i] + bz * z[i] > 0.0));
        }
        let Back { x: screen, sides: [low, high], top } = self.back;
        for i in 0..LANES {
            let distance = screen * inverse_x[i];
            let (across, up) = (distance * y[i], distance * z[i]);
            let is_on = (across >= low) & (across <= high) & (up <= top) & (up >= self.foot);
            found[i] |= u32::from((distance > 0.0) & is_on);
        }
        found
    }

    /// Returns the distance to the goal along a ray, metres, if the ray meets it.
    pub(super) fn distance(&self, direction: [f32; 3]) -> Option<f32> {
        let [x, y, z] = direction;
        let posts = self.posts.iter().filter_map(|post| self.distance_to_post(*post, direction));
        let bar = tube([x, z], self.bar, self.radius)
            .filter(|distance| (self.bar_ends[0]..=self.bar_ends[1]).contains(&(distance * y)));
        let Back { x: screen, sides: [low, high], top } = self.back;
        let back = Some(screen / x).filter(|distance| {
            let (across, up) = (distance * y, distance * z);
            *distance > 0.0 && (low..=high).contains(&across) && (self.foot..=top).contains(&up)
        });
        posts.chain(bar).chain(back).reduce(f32::min)
    }

    fn distance_to_post(&self, post: [f32; 2], [x, y, z]: [f32; 3]) -> Option<f32> {
        let side = tube([x, y], post, self.radius)
            .filter(|distance| (self.foot..=self.top).contains(&(distance * z)));
        // Seen from above, a post shows its upper end, too.
        let end = Some(self.top / z).filter(|distance| {
            let aside = [distance * x - post[0], distance * y - post[1]];
            *distance > 0.0 && aside[0] * aside[0] + aside[1] * aside[1] <= self.radius * self.radius
        });
        side.into_iter().chain(end).reduce(f32::min)
    }
}

/// Returns how far along a ray an endless cylinder is met, given in the plane across it. None if the ray misses it, or begins
/// inside.
fn tube(direction: [f32; 2], axis: [f32; 2], radius: f32) -> Option<f32> {
    let along = direction[0] * axis[0] + direction[1] * axis[1];
    let square = direction[0] * direction[0] + direction[1] * direction[1];
    let outside = axis[0] * axis[0] + axis[1] * axis[1] - radius * radius;
    // Twice the triangle between ray and axis: exact where the difference of two large squares would not be.
    let cross = direction[0] * axis[1] - direction[1] * axis[0];
    let under_root = radius * radius * square - cross * cross;
    (outside > 0.0 && along > 0.0 && under_root >= 0.0).then(|| (along - under_root.sqrt()) / square)
}
