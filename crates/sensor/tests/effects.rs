//! Comparison of the effects' hooks with closed forms.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use std::{collections::BTreeSet, fs, path::Path};

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use reality_sim_core::{
    camera::{Camera, Distortion},
    pose::{CameraPose, Motion2},
};
use reality_sim_sensor::{Effect, Growth, Noise, Role, Surface, Tone, effect, library};

#[test]
fn the_library_has_the_effects_that_reports_name() {
    let expected = "radial_distortion principal_point focal_length mount_pitch mount_roll camera_height \
        rolling_shutter time_offset motion_blur defocus chromatic_aberration vignetting tone_curve black_level \
        white_balance exposure_drift uneven_illumination sensor_noise field_dimensions odometry_scale \
        odometry_yaw_drift odometry_lateral_slip camera_yaw camera_offset tangential_distortion \
        odometry_delay imu_delay clock_jump gait_sway carpet_reflectance line_reflectance veiling_glare \
        sharpening";
    let known: BTreeSet<&str> = library().iter().map(|effect| effect.id()).collect();
    assert_eq!(known, expected.split_whitespace().collect());
    assert_eq!(library().len(), known.len());
    assert!(known.iter().all(|id| effect(id).unwrap().id() == *id) && effect("fog").is_none());
}

#[test]
fn every_file_of_an_effect_is_in_the_library() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/effects");
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let module = path.file_stem().unwrap().to_str().unwrap();
        let is_effect = fs::read_to_string(&path).unwrap().contains("impl Effect for ");
        assert_eq!(
            is_effect,
            effect(module).is_some(),
            "src/effects/{module}.rs: an effect has its module's name as its id, and two lines in src/effects.rs: \
             `mod {module};` and an entry of LIBRARY"
        );
    }
}

#[test]
fn every_effect_describes_itself_and_its_parameters() {
    for effect in library() {
        let id = effect.id();
        for text in [effect.name(), effect.because(), effect.recording_that_would_decide()] {
            assert!(
                text.len() > 15 && !text.ends_with('.') && text.starts_with(char::is_lowercase),
                "{id}: {text}"
            );
        }
        assert!(!effect.covariates().is_empty());
        let names: BTreeSet<&str> = effect.parameters().iter().map(|parameter| parameter.name).collect();
        assert_eq!(names.len(), effect.parameters().len(), "{id}");
        for parameter in effect.parameters() {
            let [low, high] = parameter.range;
            assert!(low <= parameter.neutral && parameter.neutral < high && parameter.step > 0.0, "{id}");
            assert_eq!(parameter.role == Role::Size, parameter.material > 0.0, "{id}");
            assert!(parameter.growth == Growth::Linear || low == parameter.neutral, "{id}");
            assert!(parameter.step <= parameter.material || parameter.role != Role::Size, "{id}");
        }
        assert!(effect.parameters().iter().any(|parameter| parameter.role == Role::Size), "{id}");
    }
}

fn known(id: &str) -> &'static dyn Effect {
    effect(id).unwrap()
}

#[test]
fn mount_effects_turn_and_lift_the_camera_in_its_own_axes() {
    let pose = common::pose([1.0, -0.5, 0.7], [0.5, 0.3, 0.2]);
    let nominal = pose.rotation_world_from_camera();
    let pitched = known("mount_pitch").mount(&[0.1], pose).rotation_world_from_camera();
    let expected = nominal * DVec3::new(0.0, 0.1_f64.sin(), 0.1_f64.cos());
    assert!(pitched.z_axis.distance(expected) < 1e-12 && pitched.x_axis.distance(nominal.x_axis) < 1e-12);
    let rolled = known("mount_roll").mount(&[0.1], pose).rotation_world_from_camera();
    let expected = nominal * DVec3::new(0.1_f64.cos(), 0.1_f64.sin(), 0.0);
    assert!(rolled.x_axis.distance(expected) < 1e-12 && rolled.z_axis.distance(nominal.z_axis) < 1e-12);
    assert_eq!(known("camera_height").mount(&[0.03], pose), CameraPose { height_m: 0.53, ..pose });
    assert_eq!(known("camera_yaw").mount(&[0.25], pose), CameraPose { yaw_rad: 0.7 + 0.25, ..pose });
    // Heading 0.7: ahead is (cos 0.7, sin 0.7), left is (−sin 0.7, cos 0.7).
    let beside = known("camera_offset").mount(&[0.2, 0.1], pose);
    let (sin, cos) = 0.7_f64.sin_cos();
    let place = DVec3::new(1.0 + 0.2 * cos - 0.1 * sin, -0.5 + 0.2 * sin + 0.1 * cos, 0.5);
    assert!(beside.position_in_world().distance(place) < 1e-12);
    assert_eq!(beside.rotation_world_from_camera(), nominal);
}

#[test]
fn lens_effects_are_added_to_every_model() {
    let p = [0.02, -0.01, 0.003, 0.0004];
    let bent = |camera: Camera| known("radial_distortion").lens(&p, camera).unwrap();
    let changed = |camera: &Camera| {
        let before = camera.distortion.parameters();
        let after = bent(camera.clone()).distortion.parameters();
        after.iter().zip(before).map(|(after, before)| after - before).collect::<Vec<_>>()
    };
    let near =
        |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    let (fisheye, barrel) = (common::fisheye([64, 48], 22.0), common::barrel([64, 48], 40.0));
    assert!(near(&changed(&fisheye), &p));
    assert!(near(&changed(&barrel), &[0.02, -0.01, 0.0, 0.0, 0.003]));
    let from_pinhole = bent(common::pinhole([64, 48], 40.0));
    assert!(matches!(from_pinhole.distortion, Distortion::Opencv(_)));
    assert!(near(&from_pinhole.distortion.parameters(), &[0.02, -0.01, 0.0, 0.0, 0.003]));
    let longer = known("focal_length").lens(&[0.1], fisheye.clone()).unwrap();
    assert!(near(&[longer.fx, longer.fy, longer.cx], &[1.1 * fisheye.fx, 1.1 * fisheye.fy, fisheye.cx]));
    let beside = known("principal_point").lens(&[2.0, -3.0], fisheye.clone()).unwrap();
    assert!(near(&[beside.cx, beside.cy, beside.fx], &[fisheye.cx + 2.0, fisheye.cy - 3.0, fisheye.fx]));
}

#[test]
fn a_decentred_lens_shifts_points_by_browns_formula_on_every_model() {
    let tangential = known("tangential_distortion");
    let p = [0.004, -0.003];
    // x = 0.3, y = -0.4, r² = 0.25: 2 p₁xy + p₂(r² + 2x²) and p₁(r² + 2y²) + 2 p₂xy.
    let expected = [0.004 * -0.24 - 0.003 * 0.43, 0.004 * 0.57 + 0.003 * 0.24];
    for camera in [common::pinhole([64, 48], 40.0), common::barrel([64, 48], 40.0)] {
        let point = DVec3::new(0.6, -0.8, 2.0);
        let changed = tangential.lens(&p, camera.clone()).unwrap();
        let shift = changed.project_unbounded(point).unwrap() - camera.project_unbounded(point).unwrap();
        assert!((shift - DVec2::from_array(expected) * DVec2::new(camera.fx, camera.fy)).length() < 1e-9);
        assert_eq!(tangential.shift_px(&p, &camera, point), DVec2::ZERO);
    }
    // On a fisheye the radius is the angle: 0.5 rad from the axis.
    let fisheye = common::fisheye([64, 48], 22.0);
    assert_eq!(tangential.lens(&p, fisheye.clone()).unwrap(), fisheye);
    let (sin, cos) = 0.5_f64.sin_cos();
    let shift = tangential.shift_px(&p, &fisheye, 3.0 * DVec3::new(0.6 * sin, -0.8 * sin, cos));
    assert!((shift - DVec2::from_array(expected) * DVec2::new(fisheye.fx, fisheye.fy)).length() < 1e-12);
}

#[test]
fn a_camera_keeps_the_limit_that_it_was_given_and_no_other() {
    let limited = common::fisheye([64, 48], 22.0).with_max_angle_rad(1.2).unwrap();
    for (id, p) in [("radial_distortion", [0.01]), ("focal_length", [0.1]), ("principal_point", [1.0])] {
        assert_eq!(known(id).lens(&p, limited.clone()).unwrap().max_angle_rad(), 1.2);
    }
    // A lens whose mapping turns back at its rim sees farther when it bends less.
    let bent = |k1: f64, camera: &Camera| known("radial_distortion").lens(&[k1], camera.clone()).unwrap();
    let barrel = bent(-0.2, &common::barrel([64, 48], 40.0));
    assert!(bent(0.1, &barrel).max_angle_rad() > barrel.max_angle_rad());
    assert!(bent(-0.1, &barrel).max_angle_rad() < barrel.max_angle_rad());
}

#[test]
fn times_are_those_of_rows_and_clock() {
    let rolling = known("rolling_shutter");
    for (row, delay_s) in [(0.0, -0.01), (0.5, 0.005), (1.0, 0.02)] {
        assert!((rolling.delay_s(&[0.03, 0.005], row) - delay_s).abs() < 1e-15);
    }
    assert_eq!(known("time_offset").clock_s(&[0.04]), 0.04);
    assert_eq!(known("motion_blur").exposure_s(&[0.02]), 0.02);
    let jump = |time_s: f64| known("clock_jump").picture_delay_s(&[0.1, 4.0], time_s);
    assert_eq!([jump(3.9), jump(4.0), jump(9.0)], [0.0, 0.1, 0.1]);
    let pose = common::pose([1.0, 2.0, 0.3], [0.5, 0.4, 0.0]);
    let swayed = known("gait_sway").sway(&[0.01, 0.02, 0.003, -0.004, 1.25], pose, 0.2);
    assert!((swayed.pitch_rad - 0.42).abs() < 1e-12 && (swayed.height_m - 0.496).abs() < 1e-12);
    assert_eq!(known("odometry_delay").odometry_delay_s(&[0.03]), 0.03);
    assert_eq!(known("imu_delay").attitude_delay_s(&[-0.02]), -0.02);
}

#[test]
fn vignetting_follows_the_cosine_to_the_fourth_of_a_wide_lens() {
    // The picture's corner is at 45 degrees: there a quarter of the light is left. Shape and bend follow from ρ² = 1/2 and
    // 1/4.
    let cos4 = |radius: f64| (1.0 + radius * radius).powi(-2);
    let strength = 0.75;
    let shape = 4.0 * (0.5 * strength - (1.0 - cos4(0.5_f64.sqrt())));
    let bend = (1.0 - cos4(0.5) - 0.25 * strength + 0.1875 * shape) / 0.09375;
    for step in 0..=20 {
        let radius = f64::from(step) / 20.0;
        let falloff = known("vignetting").falloff(&[strength, shape, bend], radius);
        assert!((falloff - cos4(radius)).abs() < 0.015, "{radius}: {falloff} for {}", cos4(radius));
    }
}

#[test]
fn light_and_gain_follow_their_formulas() {
    let vignetting = known("vignetting");
    assert!((vignetting.falloff(&[0.4, 0.0], 1.0) - 0.6).abs() < 1e-15);
    assert!((vignetting.falloff(&[0.4, 0.3], 0.5) - (1.0 - 0.1 + 0.3 * 0.25 * 0.75)).abs() < 1e-15);
    assert!(
        (vignetting.falloff(&[0.4, 0.0, 0.2], 0.5) - (1.0 - 0.1 - 0.2 * 0.25 * 0.75 * 0.5)).abs() < 1e-15
    );
    assert_eq!(vignetting.falloff(&[0.4, 0.3, 0.2], 0.0), 1.0);
    assert!((vignetting.falloff(&[0.4, 0.3, 0.2], 1.0) - 0.6).abs() < 1e-15);
    assert_eq!(vignetting.falloff(&[0.95, 0.0], 1.2), 0.02);
    assert_eq!(known("white_balance").gain(&[0.2, -0.1], 3.0), [1.2, 1.0, 0.9]);
    assert_eq!(known("chromatic_aberration").magnification(&[0.002, -0.001]), [1.002, 1.0, 0.999]);
    assert_eq!(known("defocus").blur_variance_px2(&[1.5], 0.3), 2.25);
    assert_eq!(known("veiling_glare").glare(&[0.03]), 0.03);
    assert_eq!(
        Surface::ALL.map(|surface| known("line_reflectance").reflectance(&[0.2], surface)),
        [1.2, 1.0]
    );
    assert_eq!(
        Surface::ALL.map(|surface| known("carpet_reflectance").reflectance(&[-0.3], surface)),
        [1.0, 0.7]
    );
    let field = common::field();
    let corner = DVec2::new(field.length_m, field.width_m) / 2.0;
    let uneven = known("uneven_illumination");
    let p = [0.1, 0.2, -0.3, 0.05, 0.1];
    assert!((uneven.light(&p, corner, &field).ln() - p.iter().sum::<f64>()).abs() < 1e-12);
    let mirrored = -0.1 - 0.2 - 0.3 + 0.05 + 0.1;
    assert!((uneven.light(&p, -corner, &field).ln() - mirrored).abs() < 1e-12);
    assert!((uneven.light(&[1.5; 5], 5.0 * corner, &field).ln() - 3.0).abs() < 1e-12);
    // Legendre's polynomials over the places that were seen; beyond them the light is that at their edge.
    let seen = [0.1, 0.2, -0.3, 0.05, 0.1, 0.07, -0.5, 0.5, -1.0, 1.0];
    let edge = seen[..6].iter().sum::<f64>();
    assert!((uneven.light(&seen, corner, &field).ln() - edge).abs() < 1e-12);
    let within = DVec2::new(0.25 * corner.x, 0.0);
    let at_half = 0.1 * 0.5 - 0.3 * (1.5 * 0.25 - 0.5) + 0.1 * -0.5 + 0.07;
    assert!((uneven.light(&seen, within, &field).ln() - at_half).abs() < 1e-12);
}

#[test]
fn exposure_runs_in_straight_lines_between_its_knots() {
    let drift = known("exposure_drift");
    let ev = |knot: usize| (knot as f64 * 0.7).sin();
    let p: Vec<f64> = [10.0, 21.0].into_iter().chain((0..12).map(ev)).collect();
    let ev_at = |time_s: f64| drift.gain(&p, time_s)[1].log2();
    for knot in 0..11 {
        let time_s = 10.0 + knot as f64;
        assert!((ev_at(time_s) - ev(knot)).abs() < 1e-12);
        assert!((ev_at(time_s + 0.25) - (0.75 * ev(knot) + 0.25 * ev(knot + 1))).abs() < 1e-12);
    }
    assert!((ev_at(-5.0) - ev(0)).abs() < 1e-12 && (ev_at(50.0) - ev(11)).abs() < 1e-12);
    assert!(drift.gain(&[0.0, 0.0, 1.0], 7.0) == [2.0; 3]);
}

#[test]
fn sensor_and_encoding_follow_their_formulas() {
    let respond = |v: f64| known("black_level").respond(&[0.1], v);
    assert!((respond(0.0) - 0.1).abs() < 1e-15 && (respond(1.0) - 1.0).abs() < 1e-15);
    let nominal = Noise { shot: 0.002, read_variance: 1e-5 };
    let noisier = known("sensor_noise").noise(&[0.003, 2e-5], nominal);
    assert!((noisier.variance(0.5) - (0.005 * 0.5 + 3e-5)).abs() < 1e-15);
    let quieter = known("sensor_noise").noise(&[-0.01, -1e-4], nominal);
    assert_eq!(quieter, Noise { shot: 0.0, read_variance: 0.0 });
    let tone = known("tone_curve").tone(&[-0.2, 0.4], Tone { gamma: 2.2, contrast: 0.0 }).unwrap();
    assert!((tone.gamma - 2.0).abs() < 1e-15);
    assert!((tone.encode(0.0625) - (0.25 - 0.4 * 0.25 * 0.75 * 0.5)).abs() < 1e-12);
    assert_eq!(known("sharpening").sharpening(&[0.4]), 0.4);
    assert_eq!([tone.encode(-1.0), tone.encode(0.25), tone.encode(7.0)], [0.0, 0.5, 1.0]);
}

#[test]
fn odometry_reports_what_its_effects_make_of_a_motion() {
    let motion = Motion2 { forward_m: 0.2, left_m: -0.1, turn_rad: 0.3 };
    let near = |a: Motion2, [forward_m, left_m, turn_rad]: [f64; 3]| {
        (a.forward_m - forward_m).abs().max((a.left_m - left_m).abs()).max((a.turn_rad - turn_rad).abs())
            < 1e-12
    };
    assert!(near(known("odometry_scale").odometry(&[0.1], motion, 0.2), [0.22, -0.11, 0.3]));
    assert!(near(known("odometry_yaw_drift").odometry(&[0.05], motion, 0.2), [0.2, -0.1, 0.31]));
    assert!(near(known("odometry_lateral_slip").odometry(&[0.2], motion, 0.2), [0.2, -0.06, 0.3]));
}

proptest! {
    #[test]
    fn a_changed_field_can_always_be_drawn(
        p in proptest::array::uniform5(-300.0..300.0),
        preset in proptest::sample::select(vec!["humanoid-kidsize-2010", "humanoid-adultsize", "spl", "msl"]),
    ) {
        let nominal = reality_sim_core::field::FieldDimensions::preset(preset).unwrap();
        let changed = known("field_dimensions").field(&p, nominal.clone());
        prop_assert!(changed.validate().is_ok(), "{:?}", changed.validate());
        let small = p.map(|value| value / 3000.0);
        let changed = known("field_dimensions").field(&small, nominal.clone());
        prop_assert!((changed.length_m - nominal.length_m - small[0]).abs() < 1e-12);
        prop_assert!((changed.width_m - nominal.width_m - small[1]).abs() < 1e-12);
        prop_assert!((changed.goal_area_length_m - nominal.goal_area_length_m - small[2]).abs() < 1e-12);
        prop_assert!((changed.goal_area_width_m - nominal.goal_area_width_m - small[3]).abs() < 1e-12);
        prop_assert!(
            (changed.center_circle_diameter_m - nominal.center_circle_diameter_m - small[4]).abs() < 1e-12
        );
    }
}
