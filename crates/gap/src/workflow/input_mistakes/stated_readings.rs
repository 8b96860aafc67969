//! Readings of what the robot states of itself, pitch, roll and odometry, compared with its reference poses.

use reality_sim_core::{
    pose::{Motion2, Pose2, wrap_angle},
    statistics::median,
};

use crate::{
    diagnostics::input_mistake::InputMistake,
    recording::{Frame, Recording, ReferenceKind},
    thresholds::{InputMistakeThresholds, Thresholds},
};

const THRESHOLDS: InputMistakeThresholds = Thresholds::DEFAULT.workflow.input_mistake;

/// Way to read pitch and roll, radians.
type AngleReading = fn([f64; 2]) -> [f64; 2];

const ANGLE_READINGS: [(InputMistake, AngleReading); 4] = [
    (InputMistake::AnglesInDegrees, |[pitch, roll]| [pitch.to_radians(), roll.to_radians()]),
    (InputMistake::PitchUp, |[pitch, roll]| [-pitch, roll]),
    (InputMistake::RollCounterClockwise, |[pitch, roll]| [pitch, -roll]),
    (InputMistake::AnglesSwapped, |[pitch, roll]| [roll, pitch]),
];

/// Way to read a pose of the odometry.
type OdometryReading = fn(Pose2) -> Pose2;

const ODOMETRY_READINGS: [(InputMistake, OdometryReading); 4] = [
    (InputMistake::OdometryInMillimeters, |pose| Pose2 {
        x_m: 1e-3 * pose.x_m,
        y_m: 1e-3 * pose.y_m,
        ..pose
    }),
    (InputMistake::OdometryInDegrees, |pose| Pose2 { yaw_rad: pose.yaw_rad.to_radians(), ..pose }),
    (InputMistake::OdometrySwapped, |pose| Pose2 { x_m: pose.y_m, y_m: pose.x_m, ..pose }),
    (InputMistake::OdometryToTheRight, |pose| Pose2 { y_m: -pose.y_m, yaw_rad: -pose.yaw_rad, ..pose }),
];

/// Returns the mistake under whose reading the robot's own statements agree with its reference poses and otherwise do not.
pub(super) fn mistake(recording: &Recording<'_>) -> Option<InputMistake> {
    if has_impossible_angles(recording) {
        return Some(InputMistake::AnglesInDegrees);
    }
    if recording.reference() != ReferenceKind::Whole {
        // Pitch and roll of such poses are the stated ones.
        return None;
    }
    let angles = |reading: AngleReading| angle_misfit(recording, reading);
    let odometry = |reading: OdometryReading| odometry_misfit(recording, reading);
    best(angles(|angles| angles), ANGLE_READINGS.map(|(mistake, reading)| (mistake, angles(reading))))
        .or_else(|| {
            best(
                odometry(|pose| pose),
                ODOMETRY_READINGS.map(|(mistake, reading)| (mistake, odometry(reading))),
            )
        })
}

/// Whether the odometry walks as the mirror image of the reference poses does.
pub(super) fn is_mirrored(recording: &Recording<'_>) -> bool {
    let mirrored = |pose: Pose2| Pose2 { y_m: -pose.y_m, yaw_rad: -pose.yaw_rad, ..pose };
    odometry_misfit(recording, mirrored) < odometry_misfit(recording, |pose| pose)
}

/// Returns the reading with the smallest misfit, if this is small and that of the files as they stand is not.
fn best(as_it_stands: f64, read: [(InputMistake, f64); 4]) -> Option<InputMistake> {
    let (mistake, least) = read.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_better = least < THRESHOLDS.least_misfit_ratio * as_it_stands;
    (is_better && least < THRESHOLDS.most_misfit).then_some(mistake)
}

/// Whether the camera would look up or down beyond the vertical in most pictures: no robot's does.
fn has_impossible_angles(recording: &Recording<'_>) -> bool {
    let frames = recording.frames.iter().map(|frame| &recording.sequence.frames[frame.index_in_sequence]);
    median(frames.map(|frame| frame.pitch_rad.abs())) > THRESHOLDS.largest_pitch_rad
}

/// Returns the mean square difference between stated and reference angles over the mean square of the latter.
fn angle_misfit(recording: &Recording<'_>, reading: AngleReading) -> f64 {
    let (mut squares, mut sizes) = (0.0, 0.0);
    for frame in &recording.frames {
        let stated = &recording.sequence.frames[frame.index_in_sequence];
        let reference = recording.trajectory.at(frame.time_s);
        let reference = [reference.pitch_rad, reference.roll_rad].map(wrap_angle);
        for (stated, reference) in reading([stated.pitch_rad, stated.roll_rad]).into_iter().zip(reference) {
            squares += wrap_angle(stated - reference).powi(2);
            sizes += reference * reference;
        }
    }
    squares / sizes
}

/// Returns the mean square difference between the odometry's movements and those of the reference poses over the mean square of
/// the latter: the mean of those ahead, to the left and in heading, so that a robot that walks straight on still tells in which
/// way it turns.
fn odometry_misfit(recording: &Recording<'_>, reading: OdometryReading) -> f64 {
    let stated = |frame: &Frame| recording.sequence.frames[frame.index_in_sequence].odometry.map(reading);
    let reference = |frame: &Frame| recording.trajectory.at(frame.time_s).planar();
    let numbers = |motion: Motion2| [motion.forward_m, motion.left_m, motion.turn_rad];
    let (mut squares, mut sizes) = ([0.0; 3], [0.0; 3]);
    let frames = recording.frames.as_slice();
    for (index, frame) in frames.iter().enumerate() {
        let is_later = |next: &&Frame| next.time_s >= frame.time_s + THRESHOLDS.odometry_step_s;
        let Some(next) = frames[index..].iter().find(is_later) else { break };
        let (Some(from), Some(to)) = (stated(frame), stated(next)) else { continue };
        let moved = numbers(reference(frame).motion_to(reference(next)));
        for (axis, stated) in numbers(from.motion_to(to)).into_iter().enumerate() {
            squares[axis] += (stated - moved[axis]).powi(2);
            sizes[axis] += (moved[axis] * moved[axis]).max(THRESHOLDS.least_movement.powi(2));
        }
    }
    squares.iter().zip(sizes).map(|(square, size)| square / size).sum::<f64>() / 3.0
}
