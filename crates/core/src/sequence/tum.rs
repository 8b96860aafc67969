//! Poses as TUM files hold them: `timestamp x y z qx qy qz qw`, the rotation world from camera.

use std::{fmt::Write, path::Path};

use glam::{DQuat, DVec3, DVec4};

use super::{
    atomic::write_atomically,
    error::{Fault, SequenceError},
    frames::number,
    text::read_and_parse,
};
use crate::pose::CameraPose;

const COLUMNS: [&str; 8] = ["timestamp", "x", "y", "z", "qx", "qy", "qz", "qw"];

/// A quaternion whose largest part is smaller has no direction that could be trusted.
const SMALLEST_QUATERNION: f64 = 1e-9;

/// A camera pose and when it was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampedPose {
    /// Seconds.
    pub timestamp_s: f64,
    /// Where the camera was.
    pub pose: CameraPose,
}

/// Reads a TUM file. Comments (`#`) and blank lines are left out, quaternions are normalised; the order is kept.
pub fn read_tum(path: &Path) -> Result<Vec<StampedPose>, SequenceError> {
    read_and_parse(path, parse_tum)
}

/// Writes a TUM file that reads back as the same poses. The file has its name only when it is complete.
pub fn write_tum(path: &Path, poses: &[StampedPose]) -> Result<(), SequenceError> {
    write_atomically(path, print_tum(path, poses)?.as_bytes())
}

/// Poses from the text of their file.
pub(super) fn parse_tum(path: &Path, text: &str) -> Result<Vec<StampedPose>, SequenceError> {
    let rows = text.lines().map(str::trim).enumerate();
    rows.filter(|(_, row)| !row.is_empty() && !row.starts_with('#'))
        .map(|(index, row)| parse_row(row).map_err(|fault| SequenceError::at(path, index + 1, fault)))
        .collect()
}

/// The text of the poses' file.
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
    for ((value, column), field) in values.iter_mut().zip(COLUMNS).zip(fields) {
        *value = number(column, field)?;
    }
    let [timestamp_s, x, y, z, qx, qy, qz, qw] = values;
    let rotation = unit_quaternion(DVec4::new(qx, qy, qz, qw)).ok_or(Fault::ZeroQuaternion)?;
    Ok(StampedPose { timestamp_s, pose: CameraPose::from_world_from_camera(DVec3::new(x, y, z), rotation) })
}

/// Scales by the largest part first: the square of a large number would be infinite.
fn unit_quaternion(parts: DVec4) -> Option<DQuat> {
    let largest = parts.abs().max_element();
    (largest >= SMALLEST_QUATERNION).then(|| DQuat::from_vec4((parts / largest).normalize()))
}
