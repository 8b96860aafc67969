//! Figures of goals, robots and people.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use reality_sim_core::field::FieldDimensions;

use crate::solid::{Part, Thing};

/// Builds the goal on one side: two posts, a bar and a back of cloth.
pub fn goal(field: &FieldDimensions, side: f32, rgb: Vec3) -> Thing {
    let x = side * field.length_m as f32 / 2.0;
    let radius = field.goal_post_diameter_m as f32 / 2.0;
    let y = field.goal_width_m as f32 / 2.0 + radius;
    let top = field.goal_height_m as f32 + radius;
    let depth = 0.45 * side;
    let post = |y: f32| Part::tube(Vec3::new(x, y, 0.0), Vec3::new(x, y, top), radius, rgb);
    let bar = Part::tube(Vec3::new(x, -y, top), Vec3::new(x, y, top), radius, rgb);
    let back = Vec3::new(x + depth, 0.0, 0.35);
    Thing::new(vec![post(y), post(-y), bar, Part::cuboid(back, Vec3::new(0.01, y, 0.35), 0.0, rgb * 0.7)])
}

/// Builds a robot with two legs, a body, two arms and a head, half a metre tall times `scale`.
pub fn robot(heading_rad: f32, rgb: Vec3, scale: f32) -> Thing {
    let side = Vec2::from_angle(heading_rad + PI / 2.0);
    let part = |across: f32, height: f32, half: [f32; 3]| {
        Part::cuboid((side * across).extend(height) * scale, Vec3::from(half) * scale, heading_rad, rgb)
    };
    Thing::new(vec![
        part(0.05, 0.12, [0.035, 0.03, 0.12]),
        part(-0.05, 0.12, [0.035, 0.03, 0.12]),
        part(0.0, 0.33, [0.05, 0.08, 0.1]),
        part(0.12, 0.32, [0.03, 0.025, 0.1]),
        part(-0.12, 0.32, [0.03, 0.025, 0.1]),
        part(0.0, 0.48, [0.04, 0.04, 0.045]),
    ])
}

/// Builds a person of 1.7 metres times `scale`.
pub fn person(heading_rad: f32, dark: Vec3, scale: f32) -> Thing {
    let cuboid = |height: f32, half: [f32; 3], rgb: Vec3| {
        Part::cuboid(Vec3::Z * height * scale, Vec3::from(half) * scale, heading_rad, rgb)
    };
    let body = cuboid(1.1, [0.14, 0.22, 0.35], dark * 1.3);
    let legs = cuboid(0.38, [0.11, 0.16, 0.38], dark);
    let head = Part::ball(Vec3::new(0.0, 0.0, 1.6 * scale), 0.12 * scale, dark * 2.0);
    Thing::new(vec![legs, body, head])
}
