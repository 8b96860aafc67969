//! Recordings as a model corrects them, against simple formulas and against the simulated camera.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::path::PathBuf;

use proptest::prelude::*;
use reality_sim_core::{
    camera::{Camera, Distortion},
    field::FieldDimensions,
    pose::{CameraPose, Motion2, Pose2, wrap_angle},
    sequence::{CameraSetup, FrameRecord, Photometry, Sequence},
};
use reality_sim_sensor::{Chain, Model, effect, library};

fn with(id: &str, values: &[f64]) -> Model {
    Model::default().with(effect(id).unwrap(), values)
}

/// Returns a robot's walk on a circle whose files state true poses and a true odometry.
fn walk() -> Sequence {
    let camera = Camera::new([320, 240], [160.0, 160.0, 159.5, 119.5], Distortion::Pinhole).unwrap();
    let photometry = Photometry {
        line_linear_rgb: Some([0.8; 3]),
        carpet_linear_rgb: Some([0.1, 0.3, 0.1]),
        ..Photometry::of_gamma(1.0)
    };
    let pose = |i: u32| {
        let angle_rad = 0.05 * f64::from(i);
        let planar = Pose2::new(1.5 * angle_rad.sin(), -1.5 * angle_rad.cos(), angle_rad);
        CameraPose::new(planar, 0.5, 0.4, 0.02)
    };
    let frames = (0..20).map(|i| FrameRecord {
        timestamp_s: 0.2 * f64::from(i),
        image: format!("images/{i}.png").into(),
        odometry: Some(Pose2::default().moved(pose(0).planar().motion_to(pose(i).planar()))),
        pitch_rad: 0.4,
        roll_rad: 0.02,
        reference_pose: Some(pose(i)),
    });
    Sequence {
        folder: PathBuf::from("walk"),
        files: Vec::new(),
        name: "walk".to_owned(),
        setup: CameraSetup { camera, mount_height_m: 0.5, photometry: Some(photometry) },
        field: FieldDimensions::preset("spl").unwrap(),
        frames: frames.collect(),
        start: None,
        poses_between_frames: Vec::new(),
        calibration: None,
        corrected_by: None,
    }
}

#[test]
fn a_model_without_effects_changes_nothing_but_the_note() {
    let stated = walk();
    let corrected = Model::default().correct(&stated).unwrap();
    assert!(corrected.corrected_by.is_some());
    assert_eq!((&corrected.setup, &corrected.field), (&stated.setup, &stated.field));
    for (stated, corrected) in stated.frames.iter().zip(&corrected.frames) {
        assert_eq!(corrected.reference_pose, stated.reference_pose);
        let [before, after] = [stated, corrected].map(|frame| frame.odometry.unwrap());
        assert!((before.position_in_world() - after.position_in_world()).length() < 1e-9);
        assert!((stated.pitch_rad - corrected.pitch_rad).abs() < 1e-12);
    }
}

#[test]
fn a_pitched_mount_turns_frames_and_reference_poses_and_is_told_as_a_mounting() {
    let (stated, model) = (walk(), with("mount_pitch", &[0.03]));
    let corrected = model.correct(&stated).unwrap();
    for frame in &corrected.frames {
        // With a roll of 0.02 rad, a pitch about the camera's own axis is one by the cosine of it.
        let expected = 0.4 + 0.03 * 0.02_f64.cos();
        assert!((frame.pitch_rad - expected).abs() < 1e-4 && (frame.roll_rad - 0.02).abs() < 1e-3);
        let pose = frame.reference_pose.unwrap();
        assert!((pose.pitch_rad - frame.pitch_rad).abs() < 1e-9);
    }
    let mounting = model.corrected(&stated.setup, &stated.field).unwrap().mounting().unwrap();
    assert!((mounting.pitch_rad - 0.03).abs() < 1e-9 && mounting.roll_rad.abs() < 1e-9);
    assert!(mounting.raised_m.abs() < 1e-12 && mounting.heading_rad.abs() < 1e-9);
}

#[test]
fn a_higher_camera_is_higher_in_the_setup_and_against_the_reference_poses() {
    let (stated, model) = (walk(), with("camera_height", &[0.04]));
    let corrected = model.correct(&stated).unwrap();
    assert!((corrected.setup.mount_height_m - stated.setup.mount_height_m - 0.04).abs() < 1e-12);
    assert!((corrected.frames[3].reference_pose.unwrap().height_m - 0.54).abs() < 1e-12);
    let mounting = model.corrected(&stated.setup, &stated.field).unwrap().mounting().unwrap();
    assert!((mounting.raised_m - 0.04).abs() < 1e-12);
}

#[test]
fn a_late_clock_moves_the_reference_poses_along_the_walk() {
    let (stated, offset_s) = (walk(), 0.05);
    let corrected = with("time_offset", &[offset_s]).correct(&stated).unwrap();
    for frame in &corrected.frames[3..16] {
        let angle_rad = 0.25 * (frame.timestamp_s + offset_s);
        let pose = frame.reference_pose.unwrap();
        assert!((pose.x_m - 1.5 * angle_rad.sin()).abs() < 1e-4, "{pose:?} at {angle_rad}");
        assert!(wrap_angle(pose.yaw_rad - angle_rad).abs() < 1e-4);
    }
}

#[test]
fn an_odometry_that_was_reset_starts_anew() {
    let mut stated = walk();
    for frame in &mut stated.frames[10..] {
        frame.odometry = None;
    }
    stated.frames[10].odometry = Some(Pose2::default());
    stated.frames[11].odometry = Some(Pose2::new(0.2, 0.0, 0.0));
    let corrected = with("odometry_scale", &[1.0]).correct(&stated).unwrap();
    assert_eq!(corrected.frames[10].odometry, Some(Pose2::default()));
    assert!((corrected.frames[11].odometry.unwrap().x_m - 0.1).abs() < 1e-9);
    assert_eq!(corrected.frames[12].odometry, None);
}

#[test]
fn white_balance_black_level_and_gamma_are_told_by_a_cameras_file() {
    let stated = walk();
    let model = with("white_balance", &[0.2, -0.1])
        .with(effect("black_level").unwrap(), [0.03])
        .with(effect("tone_curve").unwrap(), [0.2]);
    let corrected = model.corrected(&stated.setup, &stated.field).unwrap();
    assert_eq!(corrected.setup().photometry, stated.setup.photometry, "recordings keep what was stated");
    let (light, before) =
        (corrected.setup_with_light().photometry.unwrap(), stated.setup.photometry.unwrap());
    let gain = corrected.chain().gain(0.0);
    for channel in 0..3 {
        let [after, before] =
            [light, before].map(|light| light.carpet_linear_rgb.map_or(0.0, |carpet| carpet[channel]));
        assert!((after - before * gain[channel]).abs() < 1e-12);
    }
    assert!((light.gamma - before.gamma - 0.2).abs() < 1e-12, "{}", light.gamma);
    assert!(light.black_level.unwrap() > 0.0299);
}

#[test]
fn what_is_left_for_pictures_is_what_a_recording_cannot_be_corrected_by() {
    let stated = walk();
    let all = library().iter().fold(Model::default(), |model, effect| {
        let values: Vec<f64> = effect.parameters().iter().map(|parameter| parameter.neutral + 0.01).collect();
        model.with(*effect, values)
    });
    let reaches = all.reaches(&stated.setup, &stated.field);
    let rest = all.without_corrected(&stated.setup, &stated.field);
    let is_left = |id: &str| rest.values(id).is_some();
    for id in ["radial_distortion", "mount_roll", "field_dimensions", "time_offset", "odometry_yaw_drift"] {
        assert!(!is_left(id), "{id}");
    }
    for id in ["vignetting", "motion_blur", "sensor_noise", "exposure_drift", "uneven_illumination"] {
        assert!(is_left(id), "{id}");
    }
    let shading: Vec<&str> = reaches.iter().filter(|(_, reach)| reach.shading).map(|(id, _)| *id).collect();
    assert!(shading.contains(&"vignetting") && shading.contains(&"white_balance"), "{shading:?}");
    assert!(!shading.contains(&"sensor_noise"));
}

proptest! {
    #[test]
    fn the_true_motion_would_have_been_reported_so(
        forward_m in -0.3..0.3_f64, left_m in -0.3..0.3_f64, turn_rad in -0.5..0.5_f64,
        scale in -0.4..0.5_f64, drift in -0.05..0.05_f64, slip in -0.3..0.3_f64,
    ) {
        let stated = walk();
        let model = with("odometry_scale", &[scale])
            .with(effect("odometry_yaw_drift").unwrap(), [drift])
            .with(effect("odometry_lateral_slip").unwrap(), [slip]);
        let chain = Chain::new(&stated.setup, &stated.field, &model).unwrap();
        let truth = Motion2 { forward_m, left_m, turn_rad };
        let reported = chain.odometry(truth, 0.2);
        let found = model.corrected(&stated.setup, &stated.field).unwrap().true_motion(reported, 0.2);
        prop_assert!((found.forward_m - forward_m).abs() < 1e-9);
        prop_assert!((found.left_m - left_m).abs() < 1e-9);
        prop_assert!((found.turn_rad - turn_rad).abs() < 1e-9);
    }
}
