use std::path::Path;

use reality_sim_sensor::effect;

use super::*;
use crate::recording::ReferenceSource;

fn walk() -> Sequence {
    Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk")).unwrap()
}

fn injected(id: &str, size: f64) -> Result<InjectedRecording, InjectionError> {
    let walk = walk();
    let poses: Vec<_> = walk.reference_poses().collect();
    let recording = Recording::new(&walk, &poses, ReferenceSource::Measured, None).unwrap();
    inject(&recording, effect(id).unwrap(), size)
}

#[test]
fn an_effect_of_the_mount_is_hidden_in_the_poses_and_the_attitude_alone() {
    let (walk, changed) = (walk(), injected("mount_pitch", 0.02).unwrap().sequence);
    assert_eq!((&changed.setup.camera, &changed.field), (&walk.setup.camera, &walk.field));
    assert_eq!(changed.folder, walk.folder, "the pictures stay where they are");
    for (frame, was) in changed.frames.iter().zip(&walk.frames) {
        assert!((frame.pitch_rad - (was.pitch_rad - 0.02)).abs() < 1e-4);
        let (pose, was) = (frame.reference_pose.unwrap(), was.reference_pose.unwrap());
        assert!((pose.pitch_rad - (was.pitch_rad - 0.02)).abs() < 1e-4);
        assert!(pose.position_in_world().distance(was.position_in_world()) < 1e-9);
    }
}

#[test]
fn an_effect_of_the_lens_is_hidden_in_the_camera_and_the_effect_brings_it_back() {
    let (walk, changed) = (walk(), injected("principal_point", 6.0).unwrap().sequence);
    let model = Model::default().with(effect("principal_point").unwrap(), [6.0, 0.0]);
    let restored = model.corrected(&changed.setup, &changed.field).unwrap().setup();
    assert!((restored.camera.cx - walk.setup.camera.cx).abs() < 1e-9);
    assert!((changed.setup.camera.cx - walk.setup.camera.cx).abs() > 5.9);
}

#[test]
fn an_effect_of_the_odometry_is_hidden_in_its_steps() {
    let (walk, changed) = (walk(), injected("odometry_scale", 0.2).unwrap().sequence);
    let length = |sequence: &Sequence| -> f64 {
        let places: Vec<Pose2> = sequence.frames.iter().filter_map(|frame| frame.odometry).collect();
        places.windows(2).map(|pair| (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m)).sum()
    };
    assert!((length(&changed) / length(&walk) - 1.2).abs() < 0.02);
}

#[test]
fn an_effect_of_the_light_is_hidden_in_pictures_of_a_temporary_folder() {
    let (walk, changed) = (walk(), injected("vignetting", 0.4).unwrap());
    assert_eq!(changed.sequence.setup, walk.setup);
    let folder = changed.sequence.folder.clone();
    assert_ne!(folder, walk.folder);
    let [was, is] = [&walk, &changed.sequence].map(|sequence| sequence.load_image(3).unwrap());
    let sum =
        |picture: &image::RgbImage| -> u64 { picture.as_raw().iter().map(|value| u64::from(*value)).sum() };
    assert!(sum(&is) < sum(&was));
    drop(changed);
    assert!(!folder.exists(), "the folder is removed with the recording");
}

#[test]
fn what_cannot_be_hidden_is_refused() {
    assert!(matches!(injected("rolling_shutter", 0.02), Err(InjectionError::WhileExposed { .. })));
    assert!(matches!(injected("motion_blur", 0.02), Err(InjectionError::WhileExposed { .. })));
    assert!(matches!(injected("mount_pitch", 7.0), Err(InjectionError::Size { .. })));
    assert!(matches!(injected("mount_pitch", 0.0), Err(InjectionError::Size { .. })));
}
