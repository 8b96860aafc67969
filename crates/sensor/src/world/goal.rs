//! A goal's posts and crossbar: cylinders, seen as flat shapes.

use glam::DVec3;
use reality_sim_core::field::{Goal, GoalPost};

use super::Shape;

/// The posts and the crossbar of a goal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GoalBars {
    posts: [GoalPost; 2],
}

impl GoalBars {
    pub(crate) fn new(goal: &Goal) -> Self {
        Self { posts: goal.posts }
    }

    /// Flat shapes that look from `position` as the goal does. The crossbar's ends are in the posts; from within a
    /// post or a bar its sides are not seen.
    pub(crate) fn outline_from(&self, position: DVec3) -> Vec<Shape> {
        let mut shapes = Vec::with_capacity(7);
        for post in &self.posts {
            let [foot, top] = [0.0, post.height_m].map(|z_m| post.center.extend(z_m));
            shapes.extend([foot, top].map(|center| Shape::Disc { center, radius_m: post.radius_m }));
            shapes.extend(cylinder_outline(foot, top, post.radius_m, position));
        }
        let [left, right] = self.posts.map(|post| post.center.extend(post.height_m - post.radius_m));
        shapes.extend(cylinder_outline(left, right, self.posts[0].radius_m, position));
        shapes
    }
}

/// The rectangle through a cylinder's axis whose long sides look from `position` as the cylinder's do. `None` from
/// within.
fn cylinder_outline(from: DVec3, to: DVec3, radius_m: f64, position: DVec3) -> Option<Shape> {
    let along = (to - from).try_normalize()?;
    let to_axis = (from - position).reject_from_normalized(along);
    let distance_m = to_axis.length();
    if distance_m <= radius_m {
        return None;
    }
    // The planes that touch the cylinder cross the axis's distance farther out than the radius.
    let half_width_m = radius_m / (1.0 - (radius_m / distance_m).powi(2)).sqrt();
    let across = half_width_m * along.cross(to_axis / distance_m);
    Some(Shape::Quad([from - across, to - across, to + across, from + across]))
}
