//! Comparison of the chain's projections and its handling of light with closed forms.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::{CameraPose, Motion2},
    sequence::{CameraSetup, Photometry},
};
use reality_sim_sensor::{Chain, Model, Trajectory, effect, library};

const GREEN: usize = 1;

fn with(effects: &[(&str, &[f64])]) -> Model {
    effects.iter().fold(Model::default(), |model, (id, values)| model.with(effect(id).unwrap(), *values))
}

fn chain(camera: &Camera, effects: &[(&str, &[f64])]) -> Chain {
    Chain::new(&common::linear_setup(camera.clone()), &common::field(), &with(effects)).unwrap()
}

fn pinhole() -> Camera {
    common::pinhole([640, 480], 300.0)
}

/// Camera at the field's centre, looking level along +x from a metre above the ground.
fn level() -> CameraPose {
    common::pose([0.0; 3], [1.0, 0.0, 0.0])
}

/// Returns a distant point in this direction, to the right and down, seen by a level camera at the field's centre.
fn far_point(right_rad: f64, down_rad: f64) -> DVec3 {
    1e6 * DVec3::new(1.0, -right_rad.tan(), -down_rad.tan()) + DVec3::Z
}

fn seen(chain: &Chain, point: DVec3) -> DVec2 {
    chain.project(&Trajectory::still(level()), 0.0, point, GREEN).unwrap()
}

#[test]
fn a_lowered_camera_sees_the_horizon_higher_by_the_tangent_of_the_angle() {
    let camera = pinhole();
    for angle_rad in [-0.1, 0.001, 0.1] {
        let chain = chain(&camera, &[("mount_pitch", &[angle_rad])]);
        let expected = DVec2::new(camera.cx, camera.cy - camera.fy * angle_rad.tan());
        assert!(seen(&chain, far_point(0.0, 0.0)).distance(expected) < 1e-3);
    }
}

#[test]
fn a_rolled_camera_sees_the_horizon_turned_the_other_way() {
    let camera = pinhole();
    let chain = chain(&camera, &[("mount_roll", &[0.1])]);
    let seen = (seen(&chain, far_point(0.4, 0.0)) - DVec2::new(camera.cx, camera.cy))
        / DVec2::new(camera.fx, camera.fy);
    assert!(seen.distance(0.4_f64.tan() * DVec2::from_angle(-0.1)) < 1e-6);
}

#[test]
fn a_higher_camera_sees_the_ground_lower() {
    let camera = pinhole();
    let chain = chain(&camera, &[("camera_height", &[0.1])]);
    let expected = DVec2::new(camera.cx, camera.cy + camera.fy * 1.1 / 2.0);
    assert!(seen(&chain, DVec3::new(2.0, 0.0, 0.0)).distance(expected) < 1e-9);
}

#[test]
fn lens_effects_move_points_as_their_formulas_say() {
    let camera = pinhole();
    let center = DVec2::new(camera.cx, camera.cy);
    let plane = DVec2::new(0.4, 0.3);
    let from_center = |x: f64| x * plane * DVec2::new(camera.fx, camera.fy);
    let point = far_point(0.4_f64.atan(), 0.3_f64.atan());
    let cases: [(&str, &[f64], DVec2); 3] = [
        ("focal_length", &[0.05], center + from_center(1.05)),
        ("principal_point", &[7.0, -4.0], center + from_center(1.0) + DVec2::new(7.0, -4.0)),
        ("radial_distortion", &[0.1, 0.05], center + from_center(1.0 + 0.1 * 0.25 + 0.05 * 0.0625)),
    ];
    for (id, values, expected) in cases {
        assert!(seen(&chain(&camera, &[(id, values)]), point).distance(expected) < 1e-3, "{id}");
    }
    let colored = chain(&camera, &[("chromatic_aberration", &[0.01, -0.005])]);
    for (channel, scale) in [(0, 1.01), (1, 1.0), (2, 0.995)] {
        let pixel = colored.project(&Trajectory::still(level()), 0.0, point, channel).unwrap();
        assert!(pixel.distance(center + from_center(scale)) < 1e-3);
    }
    assert_eq!(colored.project(&Trajectory::still(level()), 0.0, point, 3), None);
}

/// Trajectory of a camera that turns left at a constant rate and looks along +x at time 0.
fn turning(rate_rad_per_s: f64) -> Trajectory {
    let pose = |time_s: f64| (time_s, CameraPose { yaw_rad: rate_rad_per_s * time_s, ..level() });
    Trajectory::new(&[-0.4, -0.2, 0.0, 0.2, 0.4].map(pose)).unwrap()
}

#[test]
fn a_post_leans_when_rows_are_read_while_the_camera_turns() {
    let camera = pinhole();
    let (rate, readout_s, reference_s) = (1.5, 0.06, 0.01);
    let chain = chain(&camera, &[("rolling_shutter", &[readout_s, reference_s])]);
    for i in 0..=20 {
        let point = DVec3::new(2.0, 0.0, 0.1 * f64::from(i));
        let pixel = chain.project(&turning(rate), 0.0, point, GREEN).unwrap();
        let time_s = readout_s * (pixel.y / 479.0 - 0.5) + reference_s;
        let expected_px = camera.cx + camera.fx * (rate * time_s).tan();
        assert!((pixel.x - expected_px).abs() < 1e-4, "{pixel} {expected_px}");
    }
}

#[test]
fn a_late_clock_shows_every_picture_later() {
    let camera = pinhole();
    let late = chain(&camera, &[("time_offset", &[0.05])]);
    assert_eq!(late.clock_s(), 0.05);
    let pixel = late.project(&turning(1.0), 0.1, DVec3::new(2.0, 0.0, 1.0), GREEN).unwrap();
    assert!((pixel.x - camera.cx - camera.fx * 0.15_f64.tan()).abs() < 1e-6);
}

#[test]
fn points_just_outside_the_picture_are_projected_and_others_are_not() {
    let camera = pinhole();
    let nominal = chain(&camera, &[]);
    let at = |u: f64| {
        nominal.project(
            &Trajectory::still(level()),
            0.0,
            far_point(((u - camera.cx) / camera.fx).atan(), 0.0),
            GREEN,
        )
    };
    assert!(at(639.0 + 39.0).is_some() && at(-39.0).is_some());
    assert!(at(639.0 + 41.0).is_none() && at(-41.0).is_none());
    let behind = DVec3::new(-1.0, 0.0, 1.0);
    assert_eq!(nominal.project(&Trajectory::still(level()), 0.0, behind, GREEN), None);
}

/// Generates trajectories that turn and walk as a robot does.
fn any_walk() -> impl Strategy<Value = Trajectory> {
    let pose = ([-0.2..0.2, -0.2..0.2, -0.3..0.3], [0.4..0.6, 0.2..0.6, -0.1..0.1]);
    proptest::array::uniform5(pose).prop_map(|poses| {
        let poses = poses.map(|(planar, rest)| common::pose(planar, rest));
        let times_s = [0.0, 0.2, 0.4, 0.6, 0.8];
        Trajectory::new(&times_s.into_iter().zip(poses).collect::<Vec<_>>()).unwrap()
    })
}

proptest! {
    #[test]
    fn a_point_is_seen_as_from_the_pose_of_its_row(
        walk in any_walk(),
        readout_s in -0.05..0.05f64,
        place in [0.5..3.0, -1.5..1.5],
        time_s in 0.1..0.7f64,
    ) {
        let camera = common::fisheye([640, 480], 215.0);
        let chain = chain(&camera, &[("rolling_shutter", &[readout_s, 0.01]), ("mount_roll", &[0.05])]);
        let point = DVec2::from_array(place).extend(0.0);
        if let Some(pixel) = chain.project(&walk, time_s, point, GREEN) {
            let pose = chain.pose(&walk, time_s, pixel.y / 479.0);
            let expected = camera.project_unbounded(pose.camera_from_world(point)).unwrap();
            prop_assert!(pixel.distance(expected) < 0.01, "{pixel} {expected}");
        }
    }

    #[test]
    fn a_model_of_neutral_effects_is_the_nominal_camera(walk in any_walk(), place in [0.5..3.0, -1.5..1.5]) {
        let camera = common::fisheye([640, 480], 215.0);
        let neutral = library().iter().fold(Model::default(), |model, effect| model.with(*effect, []));
        let setup = common::linear_setup(camera.clone());
        let chain = Chain::new(&setup, &common::field(), &neutral).unwrap();
        prop_assert_eq!(chain.camera(), &camera);
        prop_assert_eq!(chain.field(), &common::field());
        let point = DVec2::from_array(place).extend(0.0);
        let expected = camera.project(walk.at(0.3).camera_from_world(point));
        if let Ok(expected) = expected {
            for channel in 0..3 {
                prop_assert_eq!(chain.project(&walk, 0.3, point, channel), Some(expected));
            }
        }
    }
}

/// Camera with complete photometry.
fn measured_setup() -> CameraSetup {
    let photometry = Photometry {
        black_level: Some(0.1),
        noise_shot: Some(0.002),
        noise_read: Some(0.01),
        psf_sigma_px: Some(0.6),
        ..Photometry::of_gamma(2.0)
    };
    CameraSetup { photometry: Some(photometry), ..common::linear_setup(pinhole()) }
}

#[test]
fn the_chain_has_the_photometry_of_the_camera_file() {
    let nominal = Chain::nominal(&measured_setup(), &common::field());
    assert!((nominal.respond(0.5) - 0.55).abs() < 1e-12);
    assert!((nominal.noise().variance(0.5) - (0.002 * 0.5 + 1e-4)).abs() < 1e-12);
    // Weights of a Gaussian of 0.6 pixels sampled at the pixels' centres.
    let weights = [1.0_f64, 0.249352, 0.003866, 3.7e-6];
    let squares: f64 =
        weights.iter().zip([0.0, 1.0, 4.0, 9.0]).map(|(weight, square)| 2.0 * weight * square).sum();
    let sampled = squares / (2.0 * weights.iter().sum::<f64>() - 1.0);
    assert!((nominal.psf_variance_px2(DVec2::ZERO) - sampled).abs() < 1e-5);
    assert!((nominal.encode(0.25) - 0.5).abs() < 1e-12);
    let model = with(&[("black_level", &[0.1]), ("defocus", &[0.8]), ("tone_curve", &[-1.0])]);
    let changed = Chain::new(&measured_setup(), &common::field(), &model).unwrap();
    assert!((changed.respond(0.0) - 0.19).abs() < 1e-12);
    assert!((changed.psf_variance_px2(DVec2::ZERO) - (sampled + 0.64)).abs() < 1e-5);
    assert!((changed.encode(0.25) - 0.25).abs() < 1e-12);
    let unknown = CameraSetup { photometry: None, ..measured_setup() };
    let unknown = Chain::nominal(&unknown, &common::field());
    assert!((unknown.encode(0.5) - 0.5_f64.powf(1.0 / 2.2)).abs() < 1e-12);
    assert_eq!((unknown.respond(0.3), unknown.noise().variance(0.3)), (0.3, 0.0));
}

#[test]
fn light_is_the_product_of_ground_lens_and_exposure() {
    let camera = pinhole();
    let effects: [(&str, &[f64]); 4] = [
        ("vignetting", &[0.5]),
        ("uneven_illumination", &[0.2]),
        ("white_balance", &[0.3, -0.2]),
        ("exposure_drift", &[0.0, 11.0, 0.0, 1.0]),
    ];
    let chain = chain(&camera, &effects);
    let half_diagonal_px = 0.5 * 639.0_f64.hypot(479.0);
    let pixel = DVec2::new(camera.cx + 0.5 * half_diagonal_px, camera.cy);
    let falloff = 1.0 - 0.5 * 0.25;
    let goal_line = DVec2::new(3.0, 0.0);
    for (ground, light) in [(None, 1.0), (Some(goal_line), 0.2_f64.exp())] {
        let expected = [1.3, 1.0, 0.8].map(|gain| gain * 2.0 * falloff * light);
        let found = chain.light(1.0, pixel, ground);
        assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12));
    }
}

#[test]
fn odometry_passes_through_all_its_effects() {
    let effects: [(&str, &[f64]); 3] =
        [("odometry_scale", &[0.1]), ("odometry_yaw_drift", &[0.05]), ("odometry_lateral_slip", &[0.5])];
    let chain = chain(&pinhole(), &effects);
    let reported = chain.odometry(Motion2 { forward_m: 1.0, left_m: 0.2, turn_rad: 0.1 }, 2.0);
    assert!((reported.forward_m - 1.1).abs() < 1e-12);
    assert!((reported.left_m - (0.22 + 0.55)).abs() < 1e-12);
    assert!((reported.turn_rad - 0.2).abs() < 1e-12);
}

#[test]
fn the_chain_returns_the_changed_field() {
    let chain = chain(&pinhole(), &[("field_dimensions", &[0.2, -0.1])]);
    let expected = FieldDimensions { length_m: 6.2, width_m: 3.9, ..common::field() };
    assert!((chain.field().length_m - expected.length_m).abs() < 1e-12);
    assert!((chain.field().width_m - expected.width_m).abs() < 1e-12);
}
