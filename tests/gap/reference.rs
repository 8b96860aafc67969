//! The gap workflow and what reference poses are to the camera: turned, beside it, faster than it, noisy.

use reality_sim::{
    CameraPose, Sequence, StampedPose,
    gap::{Channel, report::text::summary},
    glam::{DQuat, DVec3},
};
use reality_sim_hidden::{Hidden, Random, Recipe};

use crate::{assert_size, named, record, recorded, reported, small};

/// Replaces every reference pose.
fn moved(sequence: &mut Sequence, change: impl Fn(CameraPose) -> CameraPose) {
    for pose in sequence.frames.iter_mut().filter_map(|frame| frame.reference_pose.as_mut()) {
        *pose = change(*pose);
    }
}

#[test]
fn a_rolling_shutter_of_twenty_milliseconds_is_named_by_reference_poses_between_the_frames() {
    let seed = 31;
    let truth = 0.02;
    let effects = vec![Hidden::RollingShutter { readout_s: truth }];
    let recipe = Recipe { effects, reference_rate_hz: Some(100.0), frames: 48, ..small(seed) };
    let (_folder, sequence) = recorded(&recipe);
    let report = reported(&sequence);
    assert_eq!(named(&report), ["rolling_shutter"], "{}", summary(&report));
    assert_size(&report, "rolling_shutter", "readout_s", truth);
}

#[test]
fn the_recording_of_the_readme_shows_what_the_readme_says() {
    let effect = Hidden::of("mount_pitch", 10.0, &mut Random::new(77)).unwrap();
    let recipe = Recipe { frames: 60, size: [640, 480], effects: vec![effect], ..Recipe::new(1) };
    let (_folder, sequence) = recorded(&recipe);
    let report = reported(&sequence);
    assert_eq!(named(&report), ["mount_pitch"], "{}", summary(&report));
    // Libraries of other machines may round the last digits of sizes otherwise.
    let summary = summary(&report);
    let (said, _) = summary.split_once(':').unwrap();
    let readme = include_str!("../../README.md").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(readme.contains(&format!("\"{said}:")), "{said}");
    let size = report.effects[0].parameters["pitch_rad"].value.abs().to_degrees();
    assert!((size - 1.0).abs() < 0.05, "{size}");
    let geometry = &report.gap.channels[&Channel::Geometry];
    assert!(geometry.left_out < 0.1, "{geometry:?}");
}

#[test]
fn a_camera_that_is_turned_against_the_frame_of_its_poses_is_named_as_such() {
    for seed in [11, 12] {
        let truth = 1.1_f64.to_radians();
        let (_folder, mut sequence) = record(seed, &[]);
        moved(&mut sequence, |pose| CameraPose { yaw_rad: pose.yaw_rad - truth, ..pose });
        let report = reported(&sequence);
        assert_eq!(named(&report), ["camera_yaw"], "seed {seed}: {}", summary(&report));
        assert_size(&report, "camera_yaw", "yaw_rad", truth);
    }
}

#[test]
fn a_camera_that_is_beside_the_place_of_its_poses_is_named_as_such() {
    for seed in [11, 12] {
        let (forward_m, left_m) = (0.06, -0.04);
        let (_folder, mut sequence) = record(seed, &[]);
        moved(&mut sequence, |pose| {
            let (sin, cos) = pose.yaw_rad.sin_cos();
            let [ahead, aside] = [[cos, sin], [-sin, cos]];
            let x_m = pose.x_m - forward_m * ahead[0] - left_m * aside[0];
            let y_m = pose.y_m - forward_m * ahead[1] - left_m * aside[1];
            CameraPose { x_m, y_m, ..pose }
        });
        let report = reported(&sequence);
        assert_eq!(named(&report), ["camera_offset"], "seed {seed}: {}", summary(&report));
        assert_size(&report, "camera_offset", "forward_m", forward_m);
        assert_size(&report, "camera_offset", "left_m", left_m);
    }
}

/// Adds errors to the reference poses that last for a time constant, seconds: metres and radians.
fn with_lasting_errors(sequence: &mut Sequence, seed: u64, sigma: f64, time_constant_s: f64) {
    let random = &mut Random::new(seed);
    let mut next = || DVec3::new(random.normal(), random.normal(), random.normal());
    let mut error = [sigma * next(), sigma * next()];
    let mut last_s = sequence.frames[0].timestamp_s;
    for frame in &mut sequence.frames {
        let kept = (-(frame.timestamp_s - last_s) / time_constant_s).exp();
        error = error.map(|error| kept * error + (1.0 - kept * kept).sqrt() * sigma * next());
        last_s = frame.timestamp_s;
        let Some(pose) = &mut frame.reference_pose else { continue };
        let rotation = pose.quaternion_world_from_camera() * DQuat::from_scaled_axis(error[1]);
        *pose = CameraPose::from_world_from_camera(pose.position_in_world() + error[0], rotation);
    }
}

#[test]
fn errors_of_the_reference_that_last_for_seconds_become_no_name() {
    for (seed, time_constant_s) in [(201, 0.5), (202, 1.0), (203, 2.0), (204, 5.0)] {
        let (_folder, mut sequence) = recorded(&Recipe { frames: 48, ..small(seed) });
        with_lasting_errors(&mut sequence, seed, 0.003, time_constant_s);
        let report = reported(&sequence);
        assert_eq!(named(&report), Vec::<&str>::new(), "{seed}, {time_constant_s} s: {}", summary(&report));
        assert_eq!(report.unexplained, [], "{seed}, {time_constant_s} s: {}", summary(&report));
    }
}

/// Takes the poses out of those between the frames that were measured this long before each frame.
fn earlier(sequence: &mut Sequence, delay_s: f64) -> Vec<CameraPose> {
    let poses = &mut sequence.poses_between_frames;
    let mut taken = Vec::new();
    for frame in &sequence.frames {
        let distance_s = |pose: &StampedPose| (pose.timestamp_s - frame.timestamp_s + delay_s).abs();
        let nearest =
            (0..poses.len()).min_by(|a, b| distance_s(&poses[*a]).total_cmp(&distance_s(&poses[*b])));
        taken.push(poses.remove(nearest.unwrap()).pose);
    }
    taken
}

#[test]
fn pitch_and_roll_that_are_late_are_named_as_a_late_imu() {
    let seed = 41;
    let delay_s = 0.055;
    let recipe = Recipe { reference_rate_hz: Some(100.0), frames: 48, ..small(seed) };
    let (_folder, mut sequence) = recorded(&recipe);
    let poses = earlier(&mut sequence, delay_s);
    for (frame, pose) in sequence.frames.iter_mut().zip(poses) {
        (frame.pitch_rad, frame.roll_rad) = (pose.pitch_rad + 0.01, pose.roll_rad - 0.02);
    }
    let report = reported(&sequence);
    assert_eq!(named(&report), ["imu_delay"], "seed {seed}: {}", summary(&report));
    assert_size(&report, "imu_delay", "delay_s", delay_s);
}

#[test]
fn a_clock_that_jumps_is_named_as_such() {
    let seed = 43;
    let jump_s = 0.105;
    let recipe = Recipe { reference_rate_hz: Some(100.0), frames: 64, ..small(seed) };
    let (_folder, mut sequence) = recorded(&recipe);
    let poses = earlier(&mut sequence, jump_s);
    for (frame, pose) in sequence.frames.iter_mut().zip(poses).skip(36) {
        frame.timestamp_s -= jump_s;
        frame.reference_pose = Some(pose);
        (frame.pitch_rad, frame.roll_rad) = (pose.pitch_rad, pose.roll_rad);
    }
    let report = reported(&sequence);
    assert_eq!(named(&report).first(), Some(&"clock_jump"), "seed {seed}: {}", summary(&report));
    assert_size(&report, "clock_jump", "jump_s", jump_s);
}

#[test]
fn a_sway_with_the_steps_that_the_reference_lacks_is_named_as_such() {
    let seed = 45;
    // The camera nods twice in a double step of 0.83 Hz.
    let (cos_rad, sin_rad) = (0.012, -0.009);
    let (_folder, mut sequence) = recorded(&Recipe { frames: 64, ..small(seed) });
    for frame in &mut sequence.frames {
        let (sin, cos) = (std::f64::consts::TAU * 1.66 * frame.timestamp_s).sin_cos();
        let Some(pose) = &mut frame.reference_pose else { continue };
        pose.pitch_rad -= cos_rad * cos + sin_rad * sin;
        frame.pitch_rad -= cos_rad * cos + sin_rad * sin;
    }
    let report = reported(&sequence);
    assert_eq!(named(&report), ["gait_sway"], "seed {seed}: {}", summary(&report));
    let effect = report.effects.iter().find(|effect| effect.id == "gait_sway").unwrap();
    let found = effect.parameters["pitch_cos_rad"].value.hypot(effect.parameters["pitch_sin_rad"].value);
    assert!((found - cos_rad.hypot(sin_rad)).abs() < 0.003, "{found}");
}
