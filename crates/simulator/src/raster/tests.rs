use std::f64::consts::PI;

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use proptest::prelude::*;
use reality_sim_core::pose::{CameraPose, Pose2};

use crate::{
    ball::Ball,
    canvas::{Canvas, Fragment, PARTS},
    humanoid::Humanoid,
    layer::Layer,
    light::Light,
    mesh::Mesh,
    raster::{Placed, draw_mesh},
    shading::Shading,
    test_view::{TestCamera, place_at, usual_pose},
    view::View,
};

const LIGHT: Light = Light { sky: Vec3::ONE, ground: Vec3::ONE };

fn drawn(view: &View<'_>, layer: &dyn Layer) -> Canvas {
    let mut canvas = Canvas::new(view.size());
    layer.draw(view, &mut canvas);
    canvas
}

/// Returns the covered part of a pixel.
fn coverage(canvas: &Canvas, u: u32, v: u32) -> f64 {
    let parts = canvas.fragments(u, v).fold(0, |parts, fragment| parts | fragment.parts);
    f64::from(parts.count_ones()) / PARTS as f64
}

/// Returns the part of a pixel whose rays meet a sphere, by many rays.
fn true_coverage(view: &View<'_>, center: DVec3, radius_m: f64, u: u32, v: u32) -> f64 {
    const SIDE: u32 = 12;
    let to_center = center - view.pose().position_in_world();
    // A ray meets the sphere within the cone that touches it.
    let cos_cone = (1.0 - (radius_m / to_center.length()).powi(2)).sqrt();
    let part = |index: u32| (f64::from(index) + 0.5) / f64::from(SIDE) - 0.5;
    let places = (0..SIDE * SIDE).map(|index| DVec2::new(part(index % SIDE), part(index / SIDE)));
    let hits = places.filter(|place| {
        let ray = view.ray(DVec2::new(u.into(), v.into()) + *place);
        ray.is_some_and(|ray| ray.dot(to_center) / to_center.length() >= cos_cone)
    });
    hits.count() as f64 / f64::from(SIDE * SIDE)
}

#[test]
fn a_ball_covers_what_rays_through_the_lens_hit() {
    for camera in TestCamera::of_all_lenses() {
        let view = camera.view(usual_pose());
        for (pixel, distance_m, radius_m) in [
            ([80.0, 60.0], 1.0, 0.1),
            ([20.3, 30.2], 1.5, 0.2),
            ([140.7, 100.1], 0.4, 0.1),
            ([60.0, 75.0], 2.0, 0.05),
        ] {
            let center = place_at(&view, pixel, distance_m);
            let ball = Ball { center_in_world: center, ..Ball::on_ground(0.0, 0.0, radius_m, Vec3::ONE) };
            let canvas = drawn(&view, &ball);
            let (mut sum, mut true_sum, mut largest) = (0.0, 0.0, 0.0_f64);
            let (mut place, mut true_place) = (DVec2::ZERO, DVec2::ZERO);
            let area = canvas.area().grown(3, view.size());
            let pixels = (area.left..area.right).flat_map(|u| (area.top..area.bottom).map(move |v| (u, v)));
            for (u, v) in pixels {
                let (found, truth) = (coverage(&canvas, u, v), true_coverage(&view, center, radius_m, u, v));
                largest = largest.max((found - truth).abs());
                (sum, true_sum) = (sum + found, true_sum + truth);
                let pixel = DVec2::new(u.into(), v.into());
                (place, true_place) = (place + found * pixel, true_place + truth * pixel);
            }
            // Sixteen parts resolve an edge to a few of them.
            assert!(largest <= 0.2, "{largest}");
            assert!((sum - true_sum).abs() < 0.01 * true_sum + 0.2, "{sum} {true_sum}");
            assert!((place / sum).distance(true_place / true_sum) < 0.03);
        }
    }
}

#[test]
fn fragments_have_the_distance_and_the_light_of_the_nearest_surface() {
    let camera = &TestCamera::of_all_lenses()[2];
    let view = camera.view(usual_pose());
    let center = place_at(&view, [80.0, 60.0], 1.0);
    let ball = Ball { center_in_world: center, ..Ball::on_ground(0.0, 0.0, 0.2, Vec3::new(0.5, 0.25, 1.0)) };
    let canvas = drawn(&view, &ball);
    let from = view.pose().position_in_world();
    for (u, v) in (66..94).flat_map(|u| (50..70).map(move |v| (u, v))) {
        let ray = view.ray(DVec2::new(u.into(), v.into())).unwrap();
        let along = ray.dot(center - from);
        let beside_squared = (center - from).length_squared() - along * along;
        if beside_squared > 0.15 * 0.15 {
            continue;
        }
        let distance_m = along - (0.2 * 0.2 - beside_squared).sqrt();
        let normal = ((from + distance_m * ray - center) / 0.2).as_vec3();
        let light = view.light().on(normal) * ball.reflectance;
        let mean = |of: fn(&Fragment) -> Vec3| {
            let weighted = canvas.fragments(u, v).map(|f| f.parts.count_ones() as f32 * of(f)).sum::<Vec3>();
            weighted / canvas.fragments(u, v).map(|f| f.parts.count_ones() as f32).sum::<f32>()
        };
        let found_m = f64::from(mean(|fragment| Vec3::splat(fragment.distance_m)).x);
        assert!((found_m - distance_m).abs() < 0.006, "{u} {v}: {found_m} {distance_m}");
        let color = mean(|fragment| fragment.color);
        assert!(color.distance(light) < 0.02, "{u} {v}: {color} {light}");
    }
}

/// Returns a large square on the ground, which the lens bends.
fn square(half_m: f32) -> Mesh {
    let mut mesh = Mesh::cuboid(Vec3::new(half_m, half_m, 0.001), Vec3::ONE);
    mesh.vertices.iter_mut().for_each(|vertex| vertex.place.z -= 0.001);
    mesh
}

#[test]
fn sides_are_as_bent_as_the_lens_bends_them() {
    for camera in TestCamera::of_all_lenses() {
        let view = camera.view(usual_pose());
        let mut canvas = Canvas::new(view.size());
        let placed = Placed::still(DAffine3::from_translation(DVec3::new(1.3, 0.5, 0.0)));
        draw_mesh(&view, &mut canvas, &square(0.6), &placed, &Shading::matt(LIGHT), 0);
        let mut different = 0.0;
        for (u, v) in (0..160).flat_map(|u| (0..120).map(move |v| (u, v))) {
            let pixel = DVec2::new(u.into(), v.into());
            let ground = view.lens().unproject_to_ground(view.pose(), pixel);
            let is_inside =
                ground.is_ok_and(|point| (point - DVec2::new(1.3, 0.5)).abs().max_element() <= 0.6);
            let covered = coverage(&canvas, u, v);
            // Pixels that an edge crosses are half inside at most.
            if (covered - f64::from(u8::from(is_inside))).abs() > 0.65 {
                different += 1.0;
            }
        }
        assert!(different <= 2.0, "{different}");
    }
}

#[test]
fn neighbouring_triangles_leave_no_gap() {
    let camera = &TestCamera::of_all_lenses()[2];
    let view = camera.view(usual_pose());
    let center = place_at(&view, [80.0, 60.0], 0.7);
    let ball = Ball { center_in_world: center, ..Ball::on_ground(0.0, 0.0, 0.4, Vec3::ONE) };
    let canvas = drawn(&view, &ball);
    let gaps = (60..100)
        .flat_map(|u| (45..75).map(move |v| (u, v)))
        .filter(|(u, v)| coverage(&canvas, *u, *v) < 1.0);
    assert_eq!(gaps.count(), 0);
}

#[test]
fn a_thing_half_outside_the_picture_says_so() {
    let camera = &TestCamera::of_all_lenses()[0];
    let view = camera.view(usual_pose());
    let truncation = |pixel: [f64; 2]| {
        let center = place_at(&view, pixel, 1.0);
        let ball = Ball { center_in_world: center, ..Ball::on_ground(0.0, 0.0, 0.1, Vec3::ONE) };
        drawn(&view, &ball).truncation(0)
    };
    assert_eq!(truncation([80.0, 60.0]), 0.0);
    assert!((truncation([-0.5, 60.0]) - 0.5).abs() < 0.1, "{}", truncation([-0.5, 60.0]));
    assert!(truncation([-40.0, 60.0]) > 0.99);
}

#[test]
fn what_cannot_be_drawn_is_left_out() {
    let camera = &TestCamera::of_all_lenses()[2];
    let view = camera.view(usual_pose());
    let position = view.pose().position_in_world();
    let ball = |center: DVec3, radius_m: f64| Ball {
        center_in_world: center,
        ..Ball::on_ground(0.0, 0.0, radius_m, Vec3::ONE)
    };
    let behind = position - 2.0 * view.world_from_camera.z_axis;
    let undrawable = [
        ball(DVec3::NAN, 0.1),
        ball(DVec3::new(1.0, f64::INFINITY, 0.0), 0.1),
        ball(place_at(&view, [80.0, 60.0], 1.0), f64::NAN),
        ball(place_at(&view, [80.0, 60.0], 1.0), -1.0),
        ball(position, 0.5),
        ball(behind, 0.1),
        ball(place_at(&view, [80.0, 60.0], 1.0), 1e-300),
    ];
    for ball in undrawable {
        let canvas = drawn(&view, &ball);
        assert!((0..160).all(|u| (0..120).all(|v| canvas.fragments(u, v).next().is_none())), "{ball:?}");
    }
    let mut canvas = Canvas::new(view.size());
    let wrong = Mesh { triangles: vec![[0, 1, 7]], ..Mesh::cuboid(Vec3::ONE, Vec3::ONE) };
    for mesh in [Mesh::default(), Mesh { triangles: vec![[0, 0, 0]], ..wrong.clone() }] {
        draw_mesh(&view, &mut canvas, &mesh, &Placed::still(DAffine3::IDENTITY), &Shading::matt(LIGHT), 0);
    }
    let out_of_range = Mesh { triangles: vec![[0, 1, 99]], ..wrong };
    draw_mesh(
        &view,
        &mut canvas,
        &out_of_range,
        &Placed::still(DAffine3::IDENTITY),
        &Shading::matt(LIGHT),
        0,
    );
    assert!(canvas.area().is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn nothing_breaks_wherever_camera_and_things_are(
        x in -3.0..3.0f64, y in -3.0..3.0f64, z in -0.5..1.5f64, radius_m in 0.001..2.0f64,
        yaw_rad in -PI..PI, pitch_rad in -1.5..1.5f64, scale in prop::sample::select(vec![1e-6, 1.0, 1e6]),
    ) {
        let pose = CameraPose::new(Pose2::new(0.1, 0.1, yaw_rad), 0.5, pitch_rad, 0.3);
        for camera in TestCamera::of_all_lenses() {
            let view = camera.view(pose);
            let ball = Ball { center_in_world: DVec3::new(x, y, z), ..Ball::on_ground(x, y, radius_m, Vec3::ONE) };
            let robot = Humanoid::standing(Pose2::new(x, y, yaw_rad), radius_m, Vec3::ONE).walking(x, DVec2::X);
            for canvas in [drawn(&view, &ball), drawn(&view, &robot)] {
                prop_assert!(canvas.area().right <= 160 && canvas.area().bottom <= 120);
                prop_assert!((0.0..=1.0).contains(&canvas.truncation(0)));
            }
            let mut canvas = Canvas::new(view.size());
            let placed = Placed {
                world_from_mesh: DAffine3::from_mat3_translation(
                    DMat3::from_diagonal(DVec3::splat(scale)), DVec3::new(x, y, z)),
                velocity_in_world: DVec3::splat(scale),
            };
            draw_mesh(&view, &mut canvas, &Mesh::sphere(1, Vec3::ONE), &placed, &Shading::matt(LIGHT), 0);
        }
    }
}
