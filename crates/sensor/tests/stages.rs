//! The picture through all stages of the camera, effect by effect.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, Vec3};
use image::RgbImage;
use reality_sim_core::{
    camera::Camera,
    field::{Curve, FieldDimensions, LineSample, sample_lines},
    pose::CameraPose,
    sequence::CameraSetup,
};
use reality_sim_sensor::{
    Chain, Frame, Model, RenderError, Renderer, SceneColors, Trajectory, effect, library,
};

fn with(effects: &[(&str, &[f64])]) -> Model {
    effects.iter().fold(Model::default(), |model, (id, values)| model.with(effect(id).unwrap(), *values))
}

fn renderer(setup: &CameraSetup, field: &FieldDimensions, effects: &[(&str, &[f64])]) -> Renderer {
    Renderer::with_model(setup, field, common::colors(), &with(effects)).unwrap()
}

#[test]
fn effects_at_neutral_values_draw_the_nominal_picture() {
    let setup = common::measured_setup(common::fisheye([160, 120], 54.0));
    let field = common::field();
    let nominal = Renderer::new(&setup, &field, common::colors());
    let neutral = library().iter().fold(Model::default(), |model, effect| model.with(*effect, []));
    let renderer = Renderer::with_model(&setup, &field, common::colors(), &neutral).unwrap();
    for seed in [None, Some(3)] {
        let drawn = renderer.draw_at(&common::walk(), 0.1, seed).unwrap();
        assert!(drawn == nominal.draw_at(&common::walk(), 0.1, seed).unwrap());
    }
}

#[test]
fn an_ideal_sensor_draws_the_same_picture_through_all_stages() {
    let setup = common::linear_setup(common::fisheye([160, 120], 54.0));
    let renderer = Renderer::new(&setup, &common::field(), common::colors());
    let pose = common::walk().at(0.1);
    let drawn = renderer.draw(pose).unwrap();
    assert!(drawn == renderer.draw_at(&Trajectory::still(pose), 0.0, Some(1)).unwrap());
    assert!(drawn == renderer.draw_at(&common::walk(), 0.1, None).unwrap());
}

#[test]
fn a_still_camera_draws_no_motion_and_a_moving_one_does() {
    let setup = common::linear_setup(common::fisheye([160, 120], 54.0));
    let nominal = Renderer::new(&setup, &common::field(), common::colors());
    let pose = common::walk().at(0.1);
    for (id, values) in [("rolling_shutter", [0.05]), ("motion_blur", [0.05]), ("time_offset", [0.05])] {
        let renderer = renderer(&setup, &common::field(), &[(id, &values)]);
        assert!(renderer.draw(pose).unwrap() == nominal.draw(pose).unwrap(), "{id}");
        assert!(renderer.draw_at(&common::walk(), 0.1, None).unwrap() != nominal.draw(pose).unwrap(), "{id}");
    }
}

#[test]
fn poses_from_which_nothing_can_be_drawn_are_refused_at_any_row() {
    let setup = common::linear_setup(common::fisheye([32, 24], 11.0));
    let sinking = renderer(&setup, &common::field(), &[("camera_height", &[-0.6])]);
    assert!(matches!(sinking.draw_at(&common::walk(), 0.0, None), Err(RenderError::NotAboveGround { .. })));
    assert!(matches!(sinking.draw(common::walk().at(0.0)), Err(RenderError::NotAboveGround { .. })));
    for id in ["rolling_shutter", "motion_blur"] {
        let moving = renderer(&setup, &common::field(), &[(id, &[0.05])]);
        assert!(matches!(moving.draw_at(&common::walk(), f64::NAN, None), Err(RenderError::NotFinite(_))));
    }
}

/// Interpolates a channel between pixels.
fn interpolated(picture: &RgbImage, channel: usize, place: DVec2) -> f64 {
    let (corner, rest) = (place.floor(), place - place.floor());
    let at = |x: f64, y: f64| {
        let pixel = (corner + DVec2::new(x, y)).as_uvec2();
        f64::from(picture.get_pixel(pixel.x, pixel.y).0[channel])
    };
    let row = |y| at(0.0, y) * (1.0 - rest.x) + at(1.0, y) * rest.x;
    row(0.0) * (1.0 - rest.y) + row(1.0) * rest.y
}

/// Projected point of a field line.
struct Projected {
    /// Midpoint between the two edges.
    middle: DVec2,
    /// Normal of the line in the picture.
    normal: DVec2,
    half_width_px: f64,
}

/// Returns the distance along the normal from the projected midpoint to the drawn line.
fn line_offset_px(picture: &RgbImage, channel: usize, line: &Projected) -> f64 {
    let dark = f64::from(common::pixel_of(common::colors().carpet_linear_rgb)[channel]);
    let count = ((line.half_width_px + 4.0) / 0.1).ceil() as i32;
    let (mut sum, mut first) = (0.0, 0.0);
    for offset in (-count..=count).map(|i| 0.1 * f64::from(i)) {
        let bright = interpolated(picture, channel, line.middle + offset * line.normal) - dark;
        sum += bright;
        first += bright * offset;
    }
    first / sum
}

/// Returns points of all straight lines that nothing else is close to, and that are neither thin nor wide. Circles may
/// appear as narrow bends, whose midpoint a pixel's mean does not show.
fn projected_lines(chain: &Chain, frame: &Frame<'_>, channel: usize) -> Vec<Projected> {
    let field = chain.field();
    let is_alone = |sample: &LineSample| {
        let from_mark = field.marks().map(|mark| mark.distance(sample.point_in_world));
        matches!(field.curves()[sample.curve], Curve::Segment { .. })
            && sample.clearance_m > 0.25
            && from_mark.iter().all(|distance_m| *distance_m > 0.25)
    };
    let project = |sample: &LineSample| {
        let seen = |offset: DVec2| frame.project((sample.point_in_world + offset).extend(0.0), channel);
        let (center, along) = (seen(DVec2::ZERO)?, seen(0.001 * sample.tangent_in_world)?);
        let (direction, px_per_m) = ((along - center).try_normalize()?, 1000.0 * along.distance(center));
        // Lines are seen at an angle: the edges' points on the normal differ from those beside the sample.
        let on_normal = |side: f64| {
            let across = side * 0.5 * field.line_width_m * sample.normal_in_world();
            let mut shift_m = 0.0;
            for _ in 0..6 {
                let pixel = seen(across + shift_m * sample.tangent_in_world)?;
                shift_m -= (pixel - center).dot(direction) / px_per_m;
            }
            seen(across + shift_m * sample.tangent_in_world)
        };
        let (left, right) = (on_normal(-1.0)?, on_normal(1.0)?);
        let half_width_px = 0.5 * left.distance(right);
        Some(Projected { middle: left.midpoint(right), normal: direction.perp(), half_width_px })
    };
    let far_inside = |pixel: DVec2| (20.0..619.0).contains(&pixel.x) && (20.0..459.0).contains(&pixel.y);
    let lines = sample_lines(field, 0.02).into_iter().filter(is_alone).filter_map(|sample| project(&sample));
    lines.filter(|line| (1.5..12.0).contains(&line.half_width_px) && far_inside(line.middle)).collect()
}

#[test]
fn lines_are_drawn_where_the_chain_projects_them_under_every_geometric_effect() {
    let field = common::field_without_goals();
    let effects: [(&str, &[f64]); 12] = [
        ("field_dimensions", &[0.1, -0.1, 0.05, 0.1, 0.1]),
        ("time_offset", &[0.08]),
        ("rolling_shutter", &[0.05, 0.01]),
        ("motion_blur", &[0.02]),
        ("mount_pitch", &[0.08]),
        ("mount_roll", &[-0.1]),
        ("camera_height", &[0.06]),
        ("radial_distortion", &[0.03, -0.004, 0.0005]),
        ("focal_length", &[0.1]),
        ("principal_point", &[9.0, -6.5]),
        ("chromatic_aberration", &[0.012, -0.01]),
        ("defocus", &[1.2]),
    ];
    let fisheye = common::fisheye([640, 480], 215.0);
    for effect in &effects {
        check_lines(&fisheye, &field, std::slice::from_ref(effect));
    }
    for camera in [fisheye, common::barrel([640, 480], 400.0)] {
        check_lines(&camera, &field, &effects);
    }
}

fn check_lines(camera: &Camera, field: &FieldDimensions, effects: &[(&str, &[f64])]) {
    let renderer = renderer(&common::linear_setup(camera.clone()), field, effects);
    let (trajectory, time_s) = (common::walk(), 0.05);
    let picture = renderer.draw_at(&trajectory, time_s, None).unwrap();
    let frame = renderer.chain().frame(&trajectory, time_s);
    for channel in 0..3 {
        let lines = projected_lines(renderer.chain(), &frame, channel);
        let offsets_px: Vec<f64> = lines.iter().map(|line| line_offset_px(&picture, channel, line)).collect();
        let mean_px = offsets_px.iter().sum::<f64>() / offsets_px.len() as f64;
        let largest_px = offsets_px.iter().fold(0.0, |largest: f64, offset| largest.max(offset.abs()));
        assert!(offsets_px.len() > 40, "{effects:?}: {}", offsets_px.len());
        assert!(largest_px < 0.1 && mean_px.abs() < 0.02, "{effects:?}: {largest_px} {mean_px}");
    }
}

/// Pose a metre above the middle line, looking straight down: 300 pixels a metre, with the image's up along +x.
fn above(x_m: f64) -> CameraPose {
    common::pose([x_m, 1.5, 0.0], [1.0, FRAC_PI_2, 0.0])
}

fn down_camera() -> Camera {
    common::pinhole([160, 120], 300.0)
}

/// Trajectory along +x, across the middle line, at this speed.
fn across(speed_m_per_s: f64) -> Trajectory {
    let pose = |time_s: f64| (time_s, above(speed_m_per_s * time_s));
    Trajectory::new(&[-0.2, -0.1, 0.0, 0.1, 0.2].map(pose)).unwrap()
}

/// Returns the row of the middle line's centre in a column, and the variance of its light along the column, pixels².
fn line_profile(picture: &RgbImage, column: u32) -> (f64, f64) {
    let dark = f64::from(common::pixel_of(common::colors().carpet_linear_rgb)[1]);
    let bright = |row: u32| f64::from(picture.get_pixel(column, row).0[1]) - dark;
    let moment = |power: i32, middle: f64| {
        (0..picture.height()).map(|row| bright(row) * (f64::from(row) - middle).powi(power)).sum::<f64>()
    };
    let sum = moment(0, 0.0);
    let middle = moment(1, 0.0) / sum;
    (middle, moment(2, middle) / sum)
}

fn profile(effects: &[(&str, &[f64])], trajectory: &Trajectory, column: u32) -> (f64, f64) {
    let field = common::field_without_goals();
    let renderer = renderer(&common::linear_setup(down_camera()), &field, effects);
    line_profile(&renderer.draw_at(trajectory, 0.0, None).unwrap(), column)
}

#[test]
fn motion_widens_lines_by_the_variance_of_the_way() {
    let (speed, exposure_s) = (1.0, 0.06);
    let (_, sharp) = profile(&[], &across(speed), 80);
    let (_, moved) = profile(&[("motion_blur", &[exposure_s])], &across(speed), 80);
    // The image's scale down the columns is 1.01 times that along the rows.
    let way_px = speed * exposure_s * 303.0;
    assert!(
        (moved - sharp - way_px * way_px / 12.0).abs() < 0.02 * way_px * way_px / 12.0,
        "{sharp} {moved}"
    );
}

#[test]
fn motion_along_a_line_leaves_it_sharp() {
    let pose = |time_s: f64| (time_s, CameraPose { y_m: 1.5 + time_s, ..above(0.0) });
    let along = Trajectory::new(&[-0.2, -0.1, 0.0, 0.1, 0.2].map(pose)).unwrap();
    let (_, sharp) = profile(&[], &along, 80);
    let (_, moved) = profile(&[("motion_blur", &[0.06])], &along, 80);
    assert!((moved - sharp).abs() < 0.1, "{sharp} {moved}");
}

#[test]
fn defocus_widens_lines_by_its_variance_in_every_direction() {
    for sigma_px in [0.4, 1.0, 3.0] {
        let (sharp_row, sharp) = profile(&[], &across(0.0), 80);
        let (blurred_row, blurred) = profile(&[("defocus", &[sigma_px])], &across(0.0), 80);
        let variance = sigma_px * sigma_px;
        assert!((blurred - sharp - variance).abs() < 0.02 * variance + 0.02, "{sharp} {blurred}");
        assert!((blurred_row - sharp_row).abs() < 0.02);
    }
    // With the camera turned by a quarter, lines run along the columns.
    let turned = Trajectory::still(CameraPose { yaw_rad: FRAC_PI_2, ..above(0.0) });
    let setup = common::linear_setup(down_camera());
    let field = common::field_without_goals();
    let variances = [0.0, 2.0].map(|sigma_px| {
        let picture =
            renderer(&setup, &field, &[("defocus", &[sigma_px])]).draw_at(&turned, 0.0, None).unwrap();
        line_profile(&image::imageops::rotate90(&picture), 60).1
    });
    assert!((variances[1] - variances[0] - 4.0).abs() < 0.1, "{variances:?}");
}

#[test]
fn rows_that_are_read_one_by_one_shear_a_line_along_the_columns() {
    let (speed, readout_s) = (0.5, 0.06);
    // The camera moves along +x, to its right, so that the line moves to the left.
    let pose = |time_s: f64| {
        (time_s, CameraPose { yaw_rad: FRAC_PI_2, y_m: 1.5, x_m: speed * time_s, ..above(0.0) })
    };
    let trajectory = Trajectory::new(&[-0.2, -0.1, 0.0, 0.1, 0.2].map(pose)).unwrap();
    let setup = common::linear_setup(down_camera());
    let field = common::field_without_goals();
    let drawn = |effects| renderer(&setup, &field, effects).draw_at(&trajectory, 0.0, None).unwrap();
    let (straight, sheared) = (drawn(&[]), drawn(&[("rolling_shutter", &[readout_s])]));
    // With the camera turned back, columns become rows, counted from the right.
    let column =
        |picture: &RgbImage, row: u32| 159.0 - line_profile(&image::imageops::rotate270(picture), row).0;
    for row in [5, 40, 60, 100, 115] {
        let moved_px = column(&sheared, row) - column(&straight, row);
        let expected_px = -speed * readout_s * (f64::from(row) / 119.0 - 0.5) * 300.0;
        assert!((moved_px - expected_px).abs() < 0.05, "{row}: {moved_px} {expected_px}");
    }
}

/// Returns pixels in whose surroundings the picture has a single colour.
fn even_pixels(picture: &RgbImage) -> Vec<(u32, u32)> {
    let (width, height) = picture.dimensions();
    let is_even = |&(u, v): &(u32, u32)| {
        let color = picture.get_pixel(u, v);
        (u - 2..=u + 2).all(|x| (v - 2..=v + 2).all(|y| picture.get_pixel(x, y) == color))
    };
    (2..height - 2).flat_map(|v| (2..width - 2).map(move |u| (u, v))).filter(is_even).collect()
}

#[test]
fn pixel_values_are_those_that_the_chain_computes() {
    let camera = common::fisheye([160, 120], 54.0);
    let field = common::field_without_goals();
    let setup = common::linear_setup(camera.clone());
    let trajectory = common::walk();
    let pose = trajectory.at(0.1);
    let plain = Renderer::new(&setup, &field, common::colors()).draw(pose).unwrap();
    let effects: [(&str, &[f64]); 7] = [
        ("vignetting", &[0.6, 0.2]),
        ("uneven_illumination", &[0.4, -0.3, -0.5, 0.2, 0.1]),
        ("white_balance", &[-0.3, -0.4]),
        ("exposure_drift", &[-1.0, 1.0, -0.1, -0.2, -0.3, -0.4, -0.5, -0.6, -0.7, -0.8, -0.9]),
        ("black_level", &[0.08]),
        ("tone_curve", &[0.7, -0.4]),
        ("sensor_noise", &[0.01]),
    ];
    let all: Vec<&[(&str, &[f64])]> =
        effects.iter().map(std::slice::from_ref).chain([effects.as_slice()]).collect();
    for effects in all {
        let renderer = renderer(&setup, &field, effects);
        let drawn = renderer.draw_at(&trajectory, 0.1, None).unwrap();
        let chain = renderer.chain();
        let mut checked = 0;
        for (u, v) in even_pixels(&plain) {
            let pixel = DVec2::new(f64::from(u), f64::from(v));
            let Ok(ground) = camera.unproject_to_ground(pose, pixel) else { continue };
            if ground.abs().cmpgt(field.carpet_half_extent_m()).any() {
                continue;
            }
            let light = chain.light(0.1, pixel, Some(ground));
            for (channel, light) in light.iter().enumerate() {
                let linear = f64::from(plain.get_pixel(u, v).0[channel]) / 255.0 * light;
                let expected = 255.0 * chain.encode(chain.respond(linear));
                let found = f64::from(drawn.get_pixel(u, v).0[channel]);
                assert!((found - expected).abs() < 1.5, "{effects:?} {pixel}: {found} {expected}");
            }
            checked += 1;
        }
        assert!(checked > 2000, "{checked}");
    }
}

#[test]
fn uneven_light_on_the_ground_leaves_walls_and_goals_alone() {
    let setup = common::linear_setup(common::fisheye([640, 480], 215.0));
    let field = common::field();
    let pose = common::pose([1.5, 0.2, 0.0], [0.5, 0.0, 0.0]);
    let uneven = renderer(&setup, &field, &[("uneven_illumination", &[0.5])]).draw(pose).unwrap();
    let even = Renderer::new(&setup, &field, common::colors()).draw(pose).unwrap();
    for color in [common::colors().wall_linear_rgb, common::colors().goal_positive_x_linear_rgb] {
        let color = image::Rgb(common::pixel_of(color));
        let of_color: Vec<_> =
            even_pixels(&even).into_iter().filter(|&(u, v)| even[(u, v)] == color).collect();
        assert!(!of_color.is_empty() && of_color.iter().all(|&(u, v)| uneven[(u, v)] == color));
    }
}

/// Returns mean and variance of a channel, in linear values, of a picture that shows only carpet.
fn carpet_noise(effects: &[(&str, &[f64])], seed: Option<u64>) -> (f64, f64) {
    let setup = common::linear_setup(common::pinhole([160, 120], 300.0));
    let colors = SceneColors { carpet_linear_rgb: Vec3::splat(0.4), ..common::colors() };
    let renderer = Renderer::with_model(&setup, &common::field(), colors, &with(effects)).unwrap();
    let pose = common::pose([1.4, 1.0, 0.0], [0.5, FRAC_PI_2, 0.0]);
    let picture = renderer.draw_at(&Trajectory::still(pose), 0.0, seed).unwrap();
    let values: Vec<f64> = picture.iter().map(|value| f64::from(*value) / 255.0).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64)
}

#[test]
fn noise_has_its_variance_and_no_mean() {
    let rounding = 1.0 / 12.0 / 255.0_f64.powi(2);
    for (p, variance) in [([0.005, 0.0], 0.002), ([0.0, 0.001], 0.001), ([0.005, 0.001], 0.003)] {
        let (mean, found) = carpet_noise(&[("sensor_noise", &p)], Some(5));
        // Four standard errors of 57,600 numbers: 2.4 % of a variance, 0.0009 of a mean.
        assert!((found - variance - rounding).abs() < 0.024 * variance, "{found} {variance}");
        assert!((mean - 0.4).abs() < 0.001, "{mean}");
    }
    assert!(carpet_noise(&[("sensor_noise", &[0.005])], None).1 < 1e-12);
}

#[test]
fn a_black_level_adds_no_noise() {
    let (_, plain) = carpet_noise(&[("sensor_noise", &[0.005])], Some(5));
    let (mean, raised) = carpet_noise(&[("sensor_noise", &[0.005]), ("black_level", &[0.2])], Some(5));
    assert!((mean - 0.52).abs() < 0.001, "{mean}");
    // Full scale stays: the black level scales the light's part by 0.8.
    assert!((raised / plain - 0.64).abs() < 0.02, "{}", raised / plain);
}

#[test]
fn noise_depends_on_seed_and_time_alone() {
    let setup = common::measured_setup(common::fisheye([64, 48], 22.0));
    let renderer = Renderer::new(&setup, &common::field(), common::colors());
    let still = Trajectory::still(common::walk().at(0.0));
    let drawn = |time_s, seed| renderer.draw_at(&still, time_s, seed).unwrap();
    assert!(drawn(0.2, Some(1)) == drawn(0.2, Some(1)));
    assert!(drawn(0.2, Some(1)) != drawn(0.2, Some(2)));
    assert!(drawn(0.2, Some(1)) != drawn(0.4, Some(1)));
    assert!(drawn(0.2, None) == drawn(0.4, None));
}

#[test]
fn without_light_the_sensor_outputs_its_black_level() {
    let camera = common::fisheye([160, 120], 54.0).with_max_angle_rad(1.0).unwrap();
    let setup = common::linear_setup(camera);
    let picture =
        renderer(&setup, &common::field(), &[("black_level", &[0.1])]).draw(common::walk().at(0.0)).unwrap();
    assert_eq!(picture.get_pixel(0, 0).0, [26; 3]);
}
