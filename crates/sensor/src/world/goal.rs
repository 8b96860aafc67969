//! A goal's posts and crossbar: cylinders, by the outlines that they have from where they are seen.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use reality_sim_core::field::{Goal, GoalPost};

use super::shape::Shape;

/// Straight pieces of the outline around a post's end: half a circle is 0.5 mm off at a post of 10 cm.
const END_PIECES: u32 = 10;

/// The posts and the crossbar of a goal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GoalBars {
    posts: [GoalPost; 2],
}

impl GoalBars {
    pub(crate) fn new(goal: &Goal) -> Self {
        Self { posts: goal.posts }
    }

    /// Outlines that look from `position` as the goal does. What `position` is inside of, or right above, is not
    /// seen.
    pub(crate) fn outlines_from(&self, position: DVec3) -> Vec<Shape> {
        let posts = self.posts.iter().filter_map(|post| post_outline(post, position));
        posts.chain(self.crossbar_outline(position)).collect()
    }

    /// The crossbar's ends are in the posts: its outline is the rectangle through its axis whose long sides look as
    /// the cylinder's do.
    fn crossbar_outline(&self, position: DVec3) -> Option<Shape> {
        let radius_m = self.posts[0].radius_m;
        let [from, to] = self.posts.map(|post| post.center.extend(post.height_m - post.radius_m));
        let along = (to - from).try_normalize()?;
        let to_axis = (from - position).reject_from_normalized(along);
        let distance_m = to_axis.length();
        if distance_m <= radius_m {
            return None;
        }
        // The planes that touch the cylinder cross the axis's distance farther out than the radius.
        let half_width_m = radius_m / (1.0 - (radius_m / distance_m).powi(2)).sqrt();
        let across = half_width_m * along.cross(to_axis / distance_m);
        Some(Shape::Polygon(vec![from - across, to - across, to + across, from + across]))
    }
}

/// Around the visible rims of foot and top. The lower rim is seen from above: its near side is the outline. So is the
/// upper rim's from below; from above it is the far side.
fn post_outline(post: &GoalPost, position: DVec3) -> Option<Shape> {
    let from_axis = position.truncate() - post.center;
    let distance_m = from_axis.length();
    if distance_m <= post.radius_m {
        return None;
    }
    let towards = from_axis / distance_m;
    // Half the angle, about the axis, between the two lines in which planes through the position touch the cylinder.
    let touch_rad = (post.radius_m / distance_m).acos();
    let rim = |from_rad: f64, to_rad: f64, z_m: f64| {
        (0..=END_PIECES).map(move |i| {
            let angle_rad = from_rad + (to_rad - from_rad) * f64::from(i) / f64::from(END_PIECES);
            (post.center + post.radius_m * DVec2::from_angle(angle_rad).rotate(towards)).extend(z_m)
        })
    };
    let top_end_rad = if position.z > post.height_m { TAU - touch_rad } else { -touch_rad };
    let foot = rim(-touch_rad, touch_rad, 0.0);
    let top = rim(touch_rad, top_end_rad, post.height_m);
    Some(Shape::Polygon(foot.chain(top).collect()))
}
