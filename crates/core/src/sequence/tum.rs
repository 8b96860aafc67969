//! Poses in TUM files: `timestamp x y z qx qy qz qw`, with the rotation world from camera.

use std::{fmt::Write, path::Path};

use glam::{DQuat, DVec3, DVec4};

use super::{
    atomic::write_atomically,
    error::{Fault, SequenceError},
    frames::{metres, number, seconds},
    limits::MAX_TABLE_BYTES,
    text::read_and_parse,
};
use crate::pose::CameraPose;

const COLUMNS: [&str; 8] = ["timestamp", "x", "y", "z", "qx", "qy", "qz", "qw"];

/// Minimum of a quaternion's largest component: below it, the quaternion has no reliable direction.
const SMALLEST_QUATERNION: f64 = 1e-9;

/// Camera pose with its timestamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampedPose {
    /// Time at which the pose was taken, seconds.
    pub timestamp_s: f64,
    /// Pose of the camera.
    pub pose: CameraPose,
}

/// Reads a TUM file. Skips comments (`#`) and blank lines, normalises quaternions and keeps the order. Fails if the
/// file cannot be read, or with the first malformed line.
pub fn read_tum(path: &Path) -> Result<Vec<StampedPose>, SequenceError> {
    read_and_parse(path, MAX_TABLE_BYTES, parse_tum)
}

/// Writes a TUM file that reads back as the same poses. The file gets its name only when it is complete. Fails if a
/// number is not finite or the file cannot be written.
pub fn write_tum(path: &Path, poses: &[StampedPose]) -> Result<(), SequenceError> {
    write_atomically(path, print_tum(path, poses)?.as_bytes())
}

/// Parses poses from the text of their file.
pub(super) fn parse_tum(path: &Path, text: &str) -> Result<Vec<StampedPose>, SequenceError> {
    let rows = text.lines().map(str::trim).enumerate();
    rows.filter(|(_, row)| !row.is_empty() && !row.starts_with('#'))
        .map(|(index, row)| parse_row(row).map_err(|fault| SequenceError::at(path, index + 1, fault)))
        .collect()
}

/// Returns the text of the poses' file.
pub(super) fn print_tum(path: &Path, poses: &[StampedPose]) -> Result<String, SequenceError> {
    let mut text = String::from("# timestamp x y z qx qy qz qw\n");
    for StampedPose { timestamp_s, pose } in poses {
        if !timestamp_s.is_finite() || !pose.is_finite() {
            let rule = "timestamps and poses must be finite numbers";
            return Err(SequenceError::of_file(path, Fault::Inconsistent { rule }));
        }
        let CameraPose { x_m, y_m, height_m, .. } = pose;
        let DQuat { x, y, z, w } = pose.quaternion_world_from_camera().normalize();
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{timestamp_s} {x_m} {y_m} {height_m} {x} {y} {z} {w}");
    }
    Ok(text)
}

fn parse_row(row: &str) -> Result<StampedPose, Fault> {
    let fields: Vec<&str> = row.split_whitespace().take(2 * COLUMNS.len()).collect();
    if fields.len() != COLUMNS.len() {
        let found = row.split_whitespace().count();
        return Err(Fault::FieldCount { found, expected: COLUMNS.len() });
    }
    let mut values = [0.0; COLUMNS.len()];
    let parsers = [seconds, metres, metres, metres, number, number, number, number];
    for (((value, column), parse), field) in values.iter_mut().zip(COLUMNS).zip(parsers).zip(fields) {
        *value = parse(column, field)?;
    }
    let [timestamp_s, x, y, z, qx, qy, qz, qw] = values;
    let rotation = unit_quaternion(DVec4::new(qx, qy, qz, qw)).ok_or(Fault::ZeroQuaternion)?;
    Ok(StampedPose { timestamp_s, pose: CameraPose::from_world_from_camera(DVec3::new(x, y, z), rotation) })
}

/// Normalises a quaternion. It is divided by its largest component first: the square of a large number would overflow.
fn unit_quaternion(parts: DVec4) -> Option<DQuat> {
    let largest = parts.abs().max_element();
    (largest >= SMALLEST_QUATERNION).then(|| DQuat::from_vec4((parts / largest).normalize()))
}
