//! Positions and colours in the drawn picture.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use std::path::Path;

use glam::{DVec2, DVec3};
use image::RgbImage;
use proptest::prelude::*;
use reality_sim_core::{
    camera::{Camera, ImageCircle},
    field::{FieldDimensions, VisibleSample, sample_lines, visible_samples},
    pose::CameraPose,
    sequence::Sequence,
};
use reality_sim_sensor::{Model, RenderError, Renderer, SceneColors, effect};

fn draw(camera: &Camera, field: &FieldDimensions, pose: CameraPose) -> RgbImage {
    let setup = common::linear_setup(camera.clone());
    Renderer::new(&setup, field, common::colors()).draw(pose).unwrap()
}

fn green(picture: &RgbImage, pixel: DVec2) -> u8 {
    picture.get_pixel(pixel.x.round() as u32, pixel.y.round() as u32).0[1]
}

/// Pose of a robot's camera that sees the field.
fn pose() -> CameraPose {
    common::pose([-1.7, 0.3, 0.4], [0.5, 0.42, 0.02])
}

fn lines_in_view(camera: &Camera, field: &FieldDimensions, pose: CameraPose) -> Vec<VisibleSample> {
    visible_samples(field, &sample_lines(field, 0.02), camera, pose, 1.0)
}

#[test]
fn lines_are_bright_where_they_are_projected_and_the_carpet_beside_is_not() {
    let walk = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/walk"));
    let sequence = Sequence::open(walk).unwrap();
    let field = common::field_without_goals();
    let camera = &sequence.setup.camera;
    let [line, carpet] = [common::colors().line_linear_rgb, common::colors().carpet_linear_rgb]
        .map(|color| common::pixel_of(color)[1]);
    let renderer = Renderer::new(&common::linear_setup(camera.clone()), &field, common::colors());
    let (mut on_line, mut beside) = (0, 0);
    for pose in sequence.reference_poses().step_by(10).map(|pose| pose.unwrap()) {
        let picture = renderer.draw(pose).unwrap();
        // From a width of 3 pixels, the whole pixel at the centre is on the line.
        for visible in lines_in_view(camera, &field, pose).iter().filter(|v| v.half_width_px > 1.5) {
            assert_eq!(green(&picture, visible.pixel), line);
            on_line += 1;
            for side in [-3.0, 3.0] {
                let sample = &visible.sample;
                let point = sample.point_in_world + side * field.line_width_m * sample.normal_in_world();
                let seen = camera.project(pose.camera_from_world(point.extend(0.0)));
                let far_from_lines =
                    field.curves().iter().all(|curve| curve.distance_m(point) > 2.5 * field.line_width_m)
                        && field.marks().iter().all(|mark| mark.distance(point) > 2.5 * field.line_width_m);
                if let (Ok(pixel), true) = (seen, far_from_lines) {
                    assert_eq!(green(&picture, pixel), carpet);
                    beside += 1;
                }
            }
        }
    }
    assert!(on_line > 500 && beside > 500, "{on_line} {beside}");
}

/// Interpolates the green channel between pixels.
fn interpolated(picture: &RgbImage, place: DVec2) -> f64 {
    let (corner, rest) = (place.floor(), place - place.floor());
    let at = |x, y| f64::from(green(picture, corner + DVec2::new(x, y)));
    let row = |y| at(0.0, y) * (1.0 - rest.x) + at(1.0, y) * rest.x;
    row(0.0) * (1.0 - rest.y) + row(1.0) * rest.y
}

/// Returns the distance from the projected edge, along the normal, at which the profile is halfway between line and carpet.
fn edge_offset_px(picture: &RgbImage, edge: DVec2, outwards: DVec2) -> f64 {
    let [line, carpet] = [common::colors().line_linear_rgb, common::colors().carpet_linear_rgb]
        .map(|color| 255.0 * f64::from(color.y));
    // The area under the profile gives the edge's position, whatever the profile's shape.
    let (reach, step) = (2.5, 0.05);
    let places = (0..(2.0 * reach / step) as u32).map(|i| -reach + step * (f64::from(i) + 0.5));
    let bright = |offset: f64| (interpolated(picture, edge + offset * outwards) - carpet) / (line - carpet);
    places.map(bright).sum::<f64>() * step - reach
}

#[test]
fn edges_of_lines_are_where_the_camera_projects_them() {
    let field = common::field_without_goals();
    let near_lines = [
        common::pose([1.6, -0.6, 0.3], [0.5, 0.7, 0.05]),
        common::pose([-0.5, -0.2, 0.9], [0.45, 0.8, -0.1]),
        common::pose([2.3, 1.5, -0.4], [0.6, 0.6, 0.0]),
    ];
    for camera in [common::fisheye([640, 480], 215.0), common::barrel([640, 480], 400.0)] {
        let offsets_px: Vec<f64> =
            near_lines.iter().flat_map(|pose| edge_offsets_px(&camera, &field, *pose)).collect();
        let mean_px = offsets_px.iter().sum::<f64>() / offsets_px.len() as f64;
        let largest_px = offsets_px.iter().fold(0.0, |largest: f64, offset| largest.max(offset.abs()));
        assert!(offsets_px.len() > 200, "{}", offsets_px.len());
        assert!(largest_px < 0.1 && mean_px.abs() < 0.01, "{largest_px} {mean_px}");
    }
}

/// Returns the offsets of all edges that no other line is close to.
fn edge_offsets_px(camera: &Camera, field: &FieldDimensions, pose: CameraPose) -> Vec<f64> {
    let picture = draw(camera, field, pose);
    let mut offsets_px = Vec::new();
    let alone = |visible: &VisibleSample| {
        let from_mark = field.marks().map(|mark| mark.distance(visible.sample.point_in_world));
        visible.half_width_px > 3.0
            && visible.sample.clearance_m > 0.2
            && from_mark.iter().all(|distance_m| *distance_m > 0.2)
    };
    for visible in lines_in_view(camera, field, pose).into_iter().filter(alone) {
        for side in [-1.0, 1.0] {
            let across = side * field.line_width_m / 2.0 * visible.sample.normal_in_world();
            let point = (visible.sample.point_in_world + across).extend(0.0);
            let edge = camera.project(pose.camera_from_world(point)).unwrap();
            if [-4.0, 4.0].iter().all(|margin| camera.check_inside(edge + *margin).is_ok()) {
                offsets_px.push(edge_offset_px(&picture, edge, side * visible.normal_in_image));
            }
        }
    }
    offsets_px
}

#[test]
fn goals_hide_what_is_behind_them_and_nothing_else() {
    let (camera, field) = (common::fisheye([640, 480], 215.0), common::field());
    let pose = common::pose([1.5, 0.2, 0.0], [0.5, 0.1, 0.0]);
    let (picture, empty) = (draw(&camera, &field, pose), draw(&camera, &common::field_without_goals(), pose));
    let goal = common::pixel_of(common::colors().goal_positive_x_linear_rgb);
    let seen = |point: DVec3| camera.project(pose.camera_from_world(point)).unwrap().round().as_uvec2();
    for post in field.goals()[1].posts {
        for height_m in [0.02, 0.3, 0.6, 0.88] {
            let pixel = seen(post.center.extend(height_m));
            assert_eq!(picture.get_pixel(pixel.x, pixel.y).0, goal);
            assert_ne!(empty.get_pixel(pixel.x, pixel.y).0, goal);
        }
    }
    let bar = seen(DVec3::new(3.0, 0.1, 0.85));
    assert_eq!(picture.get_pixel(bar.x, bar.y).0, goal);
    for beside in [DVec3::new(3.0, 0.1, 0.6), DVec3::new(3.0, 0.1, 1.0), DVec3::new(3.0, 1.0, 0.5)] {
        let pixel = seen(beside);
        assert_eq!(picture.get_pixel(pixel.x, pixel.y), empty.get_pixel(pixel.x, pixel.y));
    }
}

#[test]
fn the_nearer_goal_hides_the_farther_one() {
    let (camera, field) = (common::pinhole([200, 150], 150.0), common::field());
    for (x_m, yaw_rad, color) in [
        (-5.0, 0.0, common::colors().goal_negative_x_linear_rgb),
        (5.0, std::f64::consts::PI, common::colors().goal_positive_x_linear_rgb),
    ] {
        let post = field.goals()[usize::from(x_m > 0.0)].posts[0].center;
        // Position in line with the posts of one side.
        let pose = common::pose([x_m, post.y, yaw_rad], [0.4, 0.0, 0.0]);
        let pixel = camera.project(pose.camera_from_world(post.extend(0.4))).unwrap().round().as_uvec2();
        assert_eq!(draw(&camera, &field, pose).get_pixel(pixel.x, pixel.y).0, common::pixel_of(color));
    }
}

#[test]
fn beyond_the_image_circle_and_the_valid_angle_the_picture_is_black() {
    let circle = ImageCircle { cx: 100.0, cy: 70.0, radius: 60.0 };
    let camera = common::fisheye([200, 150], 60.0);
    let round = camera.clone().with_image_circle(Some(circle));
    let narrow = camera.clone().with_max_angle_rad(0.9).unwrap();
    for camera in [round, narrow] {
        let picture = draw(&camera, &common::field(), pose());
        for (u, v, pixel) in picture.enumerate_pixels() {
            let place = DVec2::new(f64::from(u), f64::from(v));
            let sees = camera.check_inside(place).is_ok() && camera.unproject(place).is_ok();
            assert_eq!(pixel.0 != [0; 3], sees, "{place}");
        }
    }
}

#[test]
fn pixel_values_follow_the_gamma_of_the_photometry() {
    let mut setup = common::linear_setup(common::pinhole([8, 6], 20.0));
    let looking_down = common::pose([1.0, 1.0, 0.0], [0.3, 1.5, 0.0]);
    let mut green = |gamma: Option<f64>| {
        setup.photometry = setup
            .photometry
            .zip(gamma)
            .map(|(p, gamma)| reality_sim_core::sequence::Photometry { gamma, ..p });
        let renderer = Renderer::new(&setup, &common::field(), common::colors());
        renderer.draw(looking_down).unwrap().get_pixel(4, 3).0[1]
    };
    // A fifth of full scale, calculated by hand.
    assert_eq!(green(Some(1.0)), 51);
    assert_eq!(green(Some(2.0)), 114);
    assert_eq!(green(None), 123);
}

#[test]
fn colors_are_those_of_the_camera_and_of_the_field() {
    let mut setup = common::linear_setup(common::pinhole([8, 6], 20.0));
    let field = FieldDimensions { goal_srgb_positive_x: Some([255, 188, 0]), ..common::field() };
    let colors = SceneColors::new(&setup, &field);
    assert_eq!(colors.line_linear_rgb, SceneColors::default().line_linear_rgb);
    let white_goals = FieldDimensions { goal_srgb_negative_x: None, ..field.clone() };
    let default = SceneColors::default();
    assert_eq!(
        SceneColors::new(&setup, &white_goals).goal_negative_x_linear_rgb,
        default.goal_negative_x_linear_rgb
    );
    // 188 is the sRGB value of half the light.
    assert!((colors.goal_positive_x_linear_rgb - glam::Vec3::new(1.0, 0.5, 0.0)).abs().max_element() < 0.005);
    let photometry = setup.photometry.as_mut().unwrap();
    photometry.carpet_linear_rgb = Some([0.1, 0.2, 0.3]);
    assert_eq!(SceneColors::new(&setup, &field).carpet_linear_rgb, glam::Vec3::new(0.1, 0.2, 0.3));
}

/// Returns the mean linear green of a picture drawn with a gamma of 1.
fn mean_green(picture: &RgbImage) -> f64 {
    let sum: f64 = picture.pixels().map(|pixel| f64::from(pixel.0[1])).sum();
    sum / (255.0 * f64::from(picture.width() * picture.height()))
}

#[test]
fn stray_light_adds_a_share_of_the_mean_and_a_surface_is_as_bright_as_its_reflectance() {
    let setup = common::linear_setup(common::pinhole([160, 120], 90.0));
    let drawn = |id: &str, value: f64| {
        let model = Model::default().with(effect(id).unwrap(), [value]);
        Renderer::with_model(&setup, &common::field(), common::colors(), &model)
            .unwrap()
            .draw(pose())
            .unwrap()
    };
    let (plain, veiled) = (drawn("veiling_glare", 0.0), drawn("veiling_glare", 0.2));
    assert!((mean_green(&veiled) - 1.2 * mean_green(&plain)).abs() < 2e-3);
    let darkest =
        |picture: &RgbImage| f64::from(picture.pixels().map(|pixel| pixel.0[1]).min().unwrap()) / 255.0;
    assert!((darkest(&veiled) - darkest(&plain) - 0.2 * mean_green(&plain)).abs() < 4e-3);
    let (line, carpet) = (drawn("line_reflectance", -0.5), drawn("carpet_reflectance", 1.0));
    let ratios = |changed: &RgbImage| -> Vec<f64> {
        let pairs = changed.pixels().zip(plain.pixels());
        pairs.map(|(to, from)| f64::from(to.0[1]) / f64::from(from.0[1].max(1))).collect()
    };
    let share = |changed: &RgbImage, ratio: f64| {
        let ratios = ratios(changed);
        ratios.iter().filter(|found| (*found - ratio).abs() < 0.02).count() as f64 / ratios.len() as f64
    };
    // Lines are a small part of the picture, and carpet most of it.
    assert!((0.002..0.2).contains(&share(&line, 0.5)), "{}", share(&line, 0.5));
    assert!(share(&carpet, 2.0) > 0.2 && share(&carpet, 1.0) > share(&line, 0.5), "{}", share(&carpet, 2.0));
}

#[test]
fn poses_from_which_nothing_can_be_drawn_are_errors() {
    let setup = common::linear_setup(common::pinhole([8, 6], 20.0));
    let renderer = Renderer::new(&setup, &common::field(), common::colors());
    for value in [f64::NAN, f64::INFINITY] {
        let poses = [
            CameraPose { x_m: value, ..pose() },
            CameraPose { yaw_rad: value, ..pose() },
            CameraPose { height_m: value, ..pose() },
            CameraPose { roll_rad: value, ..pose() },
        ];
        for pose in poses {
            let error = renderer.draw(pose).unwrap_err();
            assert!(matches!(error, RenderError::NotFinite(_)));
            assert!(!error.to_string().contains('\n'));
        }
    }
    for height_m in [0.0, -0.5] {
        let error = renderer.draw(CameraPose { height_m, ..pose() }).unwrap_err();
        assert_eq!(error, RenderError::NotAboveGround { height_m });
    }
}

#[test]
fn from_above_the_hall_the_field_is_seen() {
    let camera = common::pinhole([200, 150], 150.0);
    let above = common::pose([1.0, 1.0, 0.0], [9.0, std::f64::consts::FRAC_PI_2, 0.0]);
    let picture = draw(&camera, &common::field(), above);
    let pixel = camera.project(above.camera_from_world(DVec3::new(1.0, 1.0, 0.0))).unwrap();
    assert_eq!(green(&picture, pixel), common::pixel_of(common::colors().carpet_linear_rgb)[1]);
    let line = camera.project(above.camera_from_world(DVec3::new(1.0, 2.0, 0.0))).unwrap();
    assert!(green(&picture, line) > 100);
}

proptest! {
    #[test]
    fn every_finite_pose_is_drawn_or_called_too_far(
        place in proptest::array::uniform3(prop_oneof![-8.0..8.0, -1e12..1e12, Just(0.0), Just(3.0)]),
        angles in proptest::array::uniform3(-4.0..4.0),
        height_m in prop_oneof![1e-12..1e-3, 0.01..10.0, 1e3..1e12, Just(0.9), Just(4.0)],
    ) {
        let camera = common::fisheye([24, 18], 9.0);
        let pose = common::pose([place[0], place[1], angles[0]], [height_m, angles[1], angles[2]]);
        let setup = common::linear_setup(camera);
        match Renderer::new(&setup, &common::field(), common::colors()).draw(pose) {
            Ok(picture) => prop_assert_eq!(picture.dimensions(), (24, 18)),
            Err(RenderError::TooFar(_)) => prop_assert!(!pose.is_possible()),
            Err(error) => prop_assert!(false, "{}", error),
        }
    }
}
