//! Readings of reference poses, pictures and field, compared by the lines that the pictures show where they should be.

use glam::{DMat3, DQuat, DVec3};
use image::{RgbImage, imageops};
use rayon::prelude::*;
use reality_sim_core::{
    camera::Camera,
    field::{FieldDimensions, preset_names},
    pose::CameraPose,
    preprocess::{Texture, luma},
    sequence::CameraSetup,
};
use reality_sim_sensor::{Chain, Trajectory};

use super::camera_readings;
use crate::{
    diagnostics::input_mistake::InputMistake,
    linear_model::linearization::MeasureError,
    measurement::{camera::FrameCamera, line_search::search, lines::expected_lines},
    recording::{Frame, Recording, ReferenceKind},
    thresholds::{InputMistakeThresholds, Thresholds},
};

const THRESHOLDS: InputMistakeThresholds = Thresholds::DEFAULT.workflow.input_mistake;

/// Way to read a reference pose.
type PoseReading = fn(CameraPose) -> CameraPose;

/// Ways to read a reference pose, each with the mistake of those who meant it.
const POSE_READINGS: [(InputMistake, PoseReading); 12] = [
    (InputMistake::PosesInMillimeters, |pose| scaled(pose, 1e-3)),
    (InputMistake::PosesInCentimeters, |pose| scaled(pose, 1e-2)),
    (InputMistake::PosesCameraFromWorld, inverse),
    (InputMistake::PosesRealPartFirst, with_real_part_last),
    (InputMistake::PosesOfBodyAxes, of_body_axes),
    (InputMistake::PosesSwappedAxes, |pose| CameraPose {
        yaw_rad: std::f64::consts::FRAC_PI_2 - pose.yaw_rad,
        roll_rad: -pose.roll_rad,
        ..with_swapped_places(pose)
    }),
    (InputMistake::PosesSwappedPlaces, with_swapped_places),
    (InputMistake::PosesToTheRight, |pose| CameraPose {
        y_m: -pose.y_m,
        yaw_rad: -pose.yaw_rad,
        roll_rad: -pose.roll_rad,
        ..pose
    }),
    (InputMistake::PosesWrongSignOfY, |pose| CameraPose { y_m: -pose.y_m, ..pose }),
    (InputMistake::PosesDown, |pose| CameraPose { height_m: -pose.height_m, ..pose }),
    (InputMistake::PosesPitchUp, |pose| CameraPose { pitch_rad: -pose.pitch_rad, ..pose }),
    (InputMistake::PosesRollCounterClockwise, |pose| CameraPose { roll_rad: -pose.roll_rad, ..pose }),
];

/// Returns the mistake under whose reading far more lines are where they should be than as the files stand.
pub(super) fn mistake(sample: &Sample<'_>) -> Option<InputMistake> {
    let recording = sample.recording;
    let as_it_stands = Reading::as_it_stands(recording);
    let before = sample.found_share(&as_it_stands);
    // Fields have many lines in common: where most are found, another reading has to find nearly all.
    let rules = THRESHOLDS.found_before_and_after;
    let [_, least_after] = rules.into_iter().find(|[most_before, _]| before < *most_before)?;
    let readings = readings(recording, &as_it_stands);
    let found = |(mistake, reading): &(InputMistake, Reading)| (*mistake, sample.found_share(reading));
    let best_of = |readings: &[(InputMistake, Reading)]| {
        let tried: Vec<(InputMistake, f64)> = readings.par_iter().map(found).collect();
        // The first of equals: sides that are swapped rather than a league that has them so.
        tried.into_iter().rev().max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let (best, _) = best_of(&readings).filter(|(_, found)| *found >= least_after)?;
    let near = camera_readings::near(&as_it_stands.camera, best).into_iter();
    let near = near.map(|(mistake, camera)| (mistake, Reading { camera, ..as_it_stands.clone() }));
    best_of(&near.collect::<Vec<_>>()).map_or(Some(best), |(nearer, _)| Some(nearer))
}

/// Way to read a recording.
#[derive(Clone)]
pub(super) struct Reading {
    pose: PoseReading,
    picture: fn(&RgbImage) -> RgbImage,
    field: FieldDimensions,
    camera: Camera,
}

impl Reading {
    pub(super) fn as_it_stands(recording: &Recording<'_>) -> Self {
        let (field, camera) = (recording.sequence.field.clone(), recording.sequence.setup.camera.clone());
        Self { pose: |pose| pose, picture: RgbImage::clone, field, camera }
    }
}

/// Returns the ways in which the files may have been meant.
fn readings(recording: &Recording<'_>, as_it_stands: &Reading) -> Vec<(InputMistake, Reading)> {
    let mut readings = vec![
        (
            InputMistake::PicturesMirrored,
            Reading { picture: imageops::flip_horizontal, ..as_it_stands.clone() },
        ),
        (InputMistake::PicturesUpsideDown, Reading { picture: imageops::rotate180, ..as_it_stands.clone() }),
    ];
    let given = &as_it_stands.field;
    let swapped = FieldDimensions { length_m: given.width_m, width_m: given.length_m, ..given.clone() };
    let presets = preset_names().enumerate().filter_map(|(preset, name)| {
        Some((InputMistake::FieldOfAnotherLeague(preset), FieldDimensions::preset(name)?))
    });
    let fields = std::iter::once((InputMistake::FieldSwapped, swapped)).chain(presets);
    let fields = fields.filter(|(_, field)| field.validate().is_ok());
    readings.extend(fields.map(|(mistake, field)| (mistake, Reading { field, ..as_it_stands.clone() })));
    let cameras = camera_readings::cameras(&as_it_stands.camera).into_iter();
    readings.extend(cameras.map(|(mistake, camera)| (mistake, Reading { camera, ..as_it_stands.clone() })));
    // Poses that were found in the pictures fit these however the files were meant.
    if recording.reference() == ReferenceKind::Whole {
        let poses = POSE_READINGS.into_iter();
        readings.extend(poses.map(|(mistake, pose)| (mistake, Reading { pose, ..as_it_stands.clone() })));
    }
    readings
}

/// Some pictures of a recording with their reference poses as they stand.
pub(super) struct Sample<'a> {
    pub(super) recording: &'a Recording<'a>,
    pub(super) pictures: Vec<(CameraPose, RgbImage)>,
}

impl<'a> Sample<'a> {
    pub(super) fn new(recording: &'a Recording<'a>) -> Result<Self, MeasureError> {
        let every = recording.frames.len().div_ceil(THRESHOLDS.pictures).max(1);
        let picture = |frame: &Frame| -> Result<_, MeasureError> {
            Ok((recording.trajectory.at(frame.time_s), recording.picture(frame)?.0))
        };
        let pictures = recording.frames.iter().step_by(every).map(picture).collect::<Result<_, _>>()?;
        Ok(Self { recording, pictures })
    }

    /// Returns the share of the pieces of line that are found where a reading expects them; 0 if it expects few.
    fn found_share(&self, reading: &Reading) -> f64 {
        let [found, expected] = self.counts(reading);
        if expected < THRESHOLDS.least_pieces * self.pictures.len() as f64 { 0.0 } else { found / expected }
    }

    /// Returns the numbers of pieces of line that are found and expected.
    pub(super) fn counts(&self, reading: &Reading) -> [f64; 2] {
        let setup = CameraSetup { camera: reading.camera.clone(), ..self.recording.sequence.setup.clone() };
        let chain = Chain::nominal(&setup, &reading.field);
        let near_px = Thresholds::DEFAULT.workflow.alignment_near * f64::from(setup.camera.width);
        let (mut found, mut expected) = (0.0, 0.0);
        for (pose, picture) in &self.pictures {
            let pose = (reading.pose)(*pose);
            if !pose.is_finite() || pose.height_m <= 0.0 {
                continue;
            }
            let still = Trajectory::still(pose);
            let lines = expected_lines(&FrameCamera::new(&chain, &still, 0.0));
            let texture = Texture::pack(&luma(&(reading.picture)(picture)));
            found += search(&texture, &lines, near_px, |_| Some(())).len() as f64;
            expected += lines.len() as f64;
        }
        [found, expected]
    }
}

fn scaled(pose: CameraPose, factor: f64) -> CameraPose {
    CameraPose { x_m: factor * pose.x_m, y_m: factor * pose.y_m, height_m: factor * pose.height_m, ..pose }
}

fn with_swapped_places(pose: CameraPose) -> CameraPose {
    CameraPose { x_m: pose.y_m, y_m: pose.x_m, ..pose }
}

/// Reads a pose as that of the world in the camera's axes.
fn inverse(pose: CameraPose) -> CameraPose {
    let world_from_camera = pose.quaternion_world_from_camera().inverse();
    CameraPose::from_world_from_camera(-(world_from_camera * pose.position_in_world()), world_from_camera)
}

/// Reads a quaternion `a b c d` as `w x y z` instead of `x y z w`.
fn with_real_part_last(pose: CameraPose) -> CameraPose {
    let DQuat { x: a, y: b, z: c, w: d } = pose.quaternion_world_from_camera();
    CameraPose::from_world_from_camera(pose.position_in_world(), DQuat::from_xyzw(b, c, d, a).normalize())
}

/// Reads a rotation as that of axes ahead, left and up.
fn of_body_axes(pose: CameraPose) -> CameraPose {
    // The camera's axes in those of the body: right, down and into the scene.
    let body_from_camera = DMat3::from_cols(DVec3::NEG_Y, DVec3::NEG_Z, DVec3::X);
    let rotation = pose.quaternion_world_from_camera() * DQuat::from_mat3(&body_from_camera);
    CameraPose::from_world_from_camera(pose.position_in_world(), rotation)
}
