//! Comparison of the picture with brute-force ray casting: 256 rays a pixel, each to its first hit.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use glam::{DVec2, DVec3, Vec3};
use proptest::prelude::*;
use rayon::prelude::*;
use reality_sim_core::{
    camera::Camera,
    field::{Curve, FieldDimensions},
    pose::CameraPose,
};
use reality_sim_sensor::{Renderer, SceneColors};

/// Last of 256 rays: as many as in a 16 × 16 grid, but no two in one row or column (Hammersley's points). A grid would count
/// a distant line along the rows, 0.03 pixels thick, as a sixteenth of a pixel.
const LAST_RAY: u8 = 255;
/// Largest difference, at a full scale of 255. Two edges of different colours may run along each other in a third of a
/// pixel: there, the fraction that they cover together differs from the product by at most a quarter of that third: 21.3.
/// The rays themselves resolve fractions of a pixel to a sixtieth.
const LARGEST_DIFFERENCE: f32 = 26.0;
const MEAN_DIFFERENCE: f32 = 0.25;

struct Reference {
    field: FieldDimensions,
    colors: SceneColors,
    curves: Vec<Curve>,
}

impl Reference {
    fn color(&self, from: DVec3, ray: DVec3) -> Vec3 {
        let mut nearest = self.hall(from, ray);
        for (goal, color) in self
            .field
            .goals()
            .iter()
            .zip([self.colors.goal_negative_x_linear_rgb, self.colors.goal_positive_x_linear_rgb])
        {
            for post in goal.posts {
                let bottom = post.center.extend(0.0);
                let top = post.center.extend(post.height_m);
                let side = cylinder(from, ray, bottom, top, post.radius_m);
                let lid = (post.height_m - from.z) / ray.z;
                let on_lid = (from + lid * ray).truncate().distance(post.center) <= post.radius_m;
                for distance in side.into_iter().chain((lid > 0.0 && on_lid).then_some(lid)) {
                    if distance < nearest.0 {
                        nearest = (distance, color);
                    }
                }
            }
            let [left, right] = goal.posts.map(|post| post.center.extend(post.height_m - post.radius_m));
            if let Some(distance) = cylinder(from, ray, left, right, goal.posts[0].radius_m)
                && distance < nearest.0
            {
                nearest = (distance, color);
            }
        }
        nearest.1
    }

    /// Intersects a ray with ground, walls and ceiling of the hall around the camera.
    fn hall(&self, from: DVec3, ray: DVec3) -> (f64, Vec3) {
        let half = (self.field.carpet_half_extent_m() + 3.0).extend(4.0);
        let far =
            |side: f64, from: f64, ray: f64| if ray == 0.0 { f64::INFINITY } else { (side - from) / ray };
        let wall_x = far(half.x * ray.x.signum(), from.x, ray.x);
        let wall_y = far(half.y * ray.y.signum(), from.y, ray.y);
        let wall = wall_x.min(wall_y);
        let level = far(if ray.z > 0.0 { 4.0 } else { 0.0 }, from.z, ray.z);
        if wall < level {
            (wall, self.colors.wall_linear_rgb)
        } else if ray.z > 0.0 {
            (level, self.colors.ceiling_linear_rgb)
        } else {
            (level, self.ground((from + level * ray).truncate()))
        }
    }

    fn ground(&self, point: DVec2) -> Vec3 {
        let half_width = self.field.line_width_m / 2.0;
        let near = |center: DVec2, half: f64| (point - center).abs().max_element() <= half;
        let on_line = |curve: &Curve| {
            let corner = match curve {
                Curve::Segment { from, to } => near(*from, half_width) || near(*to, half_width),
                Curve::Circle { .. } => false,
            };
            corner || curve.distance_m(point) <= half_width
        };
        if self.curves.iter().any(on_line) || self.field.marks().iter().any(|mark| near(*mark, 0.05)) {
            self.colors.line_linear_rgb
        } else if point.abs().cmple(self.field.carpet_half_extent_m()).all() {
            self.colors.carpet_linear_rgb
        } else {
            self.colors.floor_linear_rgb
        }
    }

    fn pixel(&self, camera: &Camera, pose: CameraPose, u: u32, v: u32) -> Vec3 {
        let rotation = pose.rotation_world_from_camera();
        let offset = |index: u8| (f64::from(index) + 0.5) / 256.0 - 0.5;
        let color = |index: u8| {
            let pixel = DVec2::new(f64::from(u) + offset(index), f64::from(v) + offset(index.reverse_bits()));
            self.color(pose.position_in_world(), rotation * camera.unproject(pixel).unwrap())
        };
        (0..=LAST_RAY).map(color).sum::<Vec3>() / 256.0
    }
}

/// Returns the distance to a cylinder's side.
fn cylinder(from: DVec3, ray: DVec3, bottom: DVec3, top: DVec3, radius: f64) -> Option<f64> {
    let axis = (top - bottom) / top.distance(bottom);
    let across = |vector: DVec3| vector - vector.dot(axis) * axis;
    let (start, step) = (across(from - bottom), across(ray));
    let (a, b, c) = (step.length_squared(), start.dot(step), start.length_squared() - radius * radius);
    let root = (b * b - a * c).sqrt();
    [(-b - root) / a, (-b + root) / a].into_iter().find(|&distance| {
        let along = (from + distance * ray - bottom).dot(axis);
        distance > 0.0 && (0.0..=top.distance(bottom)).contains(&along)
    })
}

fn any_camera() -> impl Strategy<Value = Camera> {
    prop_oneof![
        (30.0..60.0).prop_map(|focal_px| common::fisheye([96, 72], focal_px)),
        (40.0..150.0).prop_map(|focal_px| common::pinhole([96, 72], focal_px)),
        (70.0..150.0).prop_map(|focal_px| common::barrel([96, 72], focal_px)),
    ]
}

/// Generates poses inside the hall and outside the posts.
fn any_pose() -> impl Strategy<Value = CameraPose> {
    let planar = [-5.0..5.0, -4.0..4.0, -3.1..3.1];
    (planar, [0.2..2.5, -0.3..1.2, -0.6..0.6])
        .prop_map(|(planar, rest)| common::pose(planar, rest))
        .prop_filter("in a goal", |pose| (pose.x_m.abs() - 3.0).abs() > 0.2)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn every_pixel_is_what_256_rays_show(camera in any_camera(), pose in any_pose()) {
        let colors = common::colors();
        let reference = Reference { field: common::field(), colors, curves: common::field().curves() };
        let setup = common::linear_setup(camera.clone());
        let picture = Renderer::new(&setup, &reference.field, colors).draw(pose).unwrap();
        let differences: Vec<(f32, u32, u32)> = (0..camera.width * camera.height).into_par_iter().map(|i| {
            let (u, v) = (i % camera.width, i / camera.width);
            let drawn = Vec3::from_array(picture.get_pixel(u, v).0.map(f32::from));
            ((drawn - 255.0 * reference.pixel(&camera, pose, u, v)).abs().max_element(), u, v)
        }).collect();
        let largest = differences.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let mean = differences.iter().map(|(value, ..)| value).sum::<f32>() / differences.len() as f32;
        eprintln!("{largest:?} {mean}");
        prop_assert!(largest.0 <= LARGEST_DIFFERENCE, "{largest:?}");
        prop_assert!(mean <= MEAN_DIFFERENCE, "{mean}");
    }
}
