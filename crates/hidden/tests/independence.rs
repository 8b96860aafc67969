//! The generator shares nothing with the models that are fitted: only numbers and the writer of sequences come from the
//! core.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{fs, path::Path};

/// Names that would come from the core or the sensor: projections, curves, rotations, blur, noise.
const FORBIDDEN: [&str; 22] = [
    "reality_sim_sensor",
    "reality_sim_gap",
    "reality_sim_synthesis",
    "project(",
    "project_",
    "intrinsic_gradients",
    "::Curve",
    "GoalPost",
    "LineSample",
    "sample_lines",
    "visible_samples",
    "carpet_half_extent",
    "rotation_world_from_camera",
    "quaternion_world_from_camera",
    "from_world_from_camera",
    "camera_from_world",
    "position_in_world",
    "wrap_angle",
    "motion_to",
    ".moved(Motion",
    "preprocess",
    "warp",
];

/// All names that may be imported from the core.
const ALLOWED: [&str; 11] = [
    "camera::{Camera, Distortion, Opencv, OpencvFisheye}",
    "field::FieldDimensions",
    "pose::{CameraPose, Pose2}",
    "pose::CameraPose",
    "pose::Pose2",
    "sequence::{CameraSetup, Photometry}",
    "sequence::{FrameRecord, Photometry, Sequence, StampedPose, write_tum}",
    "sequence::FrameRecord",
    "sequence::SequenceError",
    "sequence::Sequence",
    "sequence::Photometry",
];

fn sources() -> Vec<(String, String)> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    let mut sources = Vec::new();
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                sources.push((path.display().to_string(), fs::read_to_string(&path).unwrap()));
            }
        }
    }
    assert!(sources.len() > 30);
    sources
}

#[test]
fn no_source_names_what_the_fitted_models_are_made_of() {
    for (path, text) in sources() {
        for forbidden in FORBIDDEN {
            assert!(!text.contains(forbidden), "{path} has {forbidden}");
        }
    }
}

#[test]
fn only_plain_data_and_the_writer_come_from_the_core() {
    for (path, text) in sources() {
        for import in text.split("reality_sim_core::").skip(1) {
            let statement = import.split(';').next().unwrap();
            let statement = statement.split_whitespace().collect::<Vec<_>>().join(" ");
            let mut rest = statement;
            for allowed in ALLOWED {
                rest = rest.replace(allowed, "");
            }
            let left: String = rest.chars().filter(|letter| letter.is_alphanumeric()).collect();
            assert!(left.is_empty(), "{path} imports {left}");
        }
    }
}
