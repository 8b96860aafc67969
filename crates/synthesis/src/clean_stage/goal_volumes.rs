//! Space that the goals take up: what is seen through it is neither empty ground nor a thing that stood there.

use glam::{DVec3, Vec3};
use reality_sim_core::{field::FieldDimensions, warp::ProxyGeometry};

/// Distance by which a goal may extend beyond what the field's dimensions and the measured depth say, metres: posts, nets and
/// their feet are not in them.
const MARGIN_M: f64 = 0.12;

/// Boxes around both goals.
#[derive(Debug, Clone, Copy)]
pub(super) struct GoalVolumes([[Vec3; 2]; 2]);

impl GoalVolumes {
    /// Takes the goals' depth from the proxy geometry.
    pub fn new(field: &FieldDimensions, proxy: &ProxyGeometry) -> Self {
        let [front, back, ..] = proxy.billboards;
        let half_width = field.goal_width_m / 2.0 + field.goal_post_diameter_m + MARGIN_M;
        let height = field.goal_height_m + field.goal_post_diameter_m + MARGIN_M;
        let near = front.x_m.abs() - field.goal_post_diameter_m / 2.0 - MARGIN_M;
        let far = back.x_m.abs() + MARGIN_M;
        let one = [DVec3::new(near, -half_width, 0.0), DVec3::new(far, half_width, height)];
        let other = [DVec3::new(-far, -half_width, 0.0), DVec3::new(-near, half_width, height)];
        Self([one, other].map(|corners| corners.map(DVec3::as_vec3)))
    }

    /// Returns whether the way between two points leads through a goal.
    pub fn hide(&self, from: Vec3, to: Vec3) -> bool {
        self.0.iter().any(|[min, max]| {
            let way = to - from;
            // Parallel ways give infinities of the right signs, or NaN on a face, which the comparison below takes as a miss.
            let (a, b) = ((*min - from) / way, (*max - from) / way);
            let enters = a.min(b).max_element().max(0.0);
            let leaves = a.max(b).min_element().min(1.0);
            enters < leaves
        })
    }
}

#[cfg(test)]
mod tests {
    use reality_sim_core::warp::Hall;

    use super::*;

    #[test]
    fn a_way_through_a_goal_is_hidden_and_one_beside_or_over_it_is_not() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let goals = GoalVolumes::new(&field, &ProxyGeometry::new(&Hall::usual(&field), &field));
        let eye = Vec3::new(0.0, 0.0, 0.5);
        for hidden in [[3.6, 0.0, 0.0], [-3.2, 0.3, 0.0], [3.05, 0.8, 0.0]] {
            assert!(goals.hide(eye, Vec3::from_array(hidden)), "{hidden:?}");
        }
        for seen in [[2.8, 0.0, 0.0], [3.6, 2.0, 0.0], [0.1, 0.0, 0.0], [-2.0, 1.9, 0.0]] {
            assert!(!goals.hide(eye, Vec3::from_array(seen)), "{seen:?}");
        }
        assert!(!goals.hide(Vec3::new(2.0, 0.0, 2.0), Vec3::new(5.0, 0.0, 2.0)), "over it");
    }
}
