//! A goal's posts and crossbar: cylinders, drawn as their outlines from the camera position.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use reality_sim_core::field::{Goal, GoalPost};

use super::shape::Shape;

/// Smallest number of straight segments of the outline around a post's end: half a circle is 0.6 mm off at a post of 10 cm.
const LEAST_PIECES: f64 = 10.0;

/// Largest angle between a post's rim and the segments for it, radians: 0.06 pixels at a focal length of 120. Half a
/// circle of a post of 10 cm needs more than the fewest segments nearer than 1.2 m.
const LARGEST_SAGITTA_RAD: f64 = 5e-4;

/// Largest number of segments, for cameras that touch a rim.
const MOST_PIECES: f64 = 64.0;

/// Posts and crossbar of a goal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GoalBars {
    posts: [GoalPost; 2],
}

impl GoalBars {
    pub(crate) fn new(goal: &Goal) -> Self {
        Self { posts: goal.posts }
    }

    /// Returns outlines that look like the goal from `position`. Posts and bars that contain `position` or are directly
    /// below it are left out.
    pub(crate) fn outlines_from(&self, position: DVec3) -> Vec<Shape> {
        let posts = self.posts.iter().filter_map(|post| post_outline(post, position));
        posts.chain(self.crossbar_outline(position)).collect()
    }

    /// Returns the crossbar's outline: the rectangle through its axis whose long sides look like the cylinder's. Its ends
    /// are hidden inside the posts.
    fn crossbar_outline(&self, position: DVec3) -> Option<Shape> {
        let radius_m = self.posts[0].radius_m;
        let [from, to] = self.posts.map(|post| post.center.extend(post.height_m - post.radius_m));
        let along = (to - from).try_normalize()?;
        let to_axis = (from - position).reject_from_normalized(along);
        let distance_m = to_axis.length();
        if distance_m <= radius_m {
            return None;
        }
        // At the distance of the axis, the planes tangent to the cylinder are farther apart than its diameter.
        let half_width_m = radius_m / (1.0 - (radius_m / distance_m).powi(2)).sqrt();
        let across = half_width_m * along.cross(to_axis / distance_m);
        Some(Shape::Polygon(vec![from - across, to - across, to + across, from + across]))
    }
}

/// Returns the number of segments for an arc whose nearest place is so far away.
fn pieces(radius_m: f64, arc_rad: f64, nearest_m: f64) -> u32 {
    // The middle of a segment of the angle α is r (1 − cos α/2) ≈ r α² / 8 beside the arc.
    let wanted = arc_rad.abs() * (radius_m / (8.0 * LARGEST_SAGITTA_RAD * nearest_m)).sqrt();
    wanted.ceil().clamp(LEAST_PIECES, MOST_PIECES) as u32
}

/// Returns the outline around the visible rims of a post's foot and top. The lower rim is seen from above, so that its near
/// side is the outline. The same holds for the upper rim seen from below; from above, its far side is the outline.
fn post_outline(post: &GoalPost, position: DVec3) -> Option<Shape> {
    let from_axis = position.truncate() - post.center;
    let distance_m = from_axis.length();
    if distance_m <= post.radius_m {
        return None;
    }
    let towards = from_axis / distance_m;
    // Half the angle about the axis between the two lines where planes through the position are tangent to the cylinder.
    let touch_rad = (post.radius_m / distance_m).acos();
    let rim = |from_rad: f64, to_rad: f64, z_m: f64| {
        let nearest_m = (distance_m - post.radius_m).hypot(position.z - z_m);
        let pieces = pieces(post.radius_m, to_rad - from_rad, nearest_m);
        (0..=pieces).map(move |i| {
            let angle_rad = from_rad + (to_rad - from_rad) * f64::from(i) / f64::from(pieces);
            (post.center + post.radius_m * DVec2::from_angle(angle_rad).rotate(towards)).extend(z_m)
        })
    };
    let top_end_rad = if position.z > post.height_m { TAU - touch_rad } else { -touch_rad };
    let foot = rim(-touch_rad, touch_rad, 0.0);
    let top = rim(touch_rad, top_end_rad, post.height_m);
    Some(Shape::Polygon(foot.chain(top).collect()))
}
