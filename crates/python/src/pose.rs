//! Poses as tuples.

use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::{CameraPose, Pose2};

/// Numbers of a pose: x, y, yaw, height, pitch and roll, metres and radians.
pub type Numbers = (f64, f64, f64, f64, f64, f64);

/// Makes a pose of three or six numbers; the last three are otherwise those of `usual`.
pub fn camera_pose(numbers: &[f64], usual: CameraPose) -> PyResult<CameraPose> {
    if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
        return Err(PyValueError::new_err(format!(
            "pose: {number} is no number: give finite metres and radians"
        )));
    }
    match *numbers {
        [x_m, y_m, yaw_rad] => Ok(usual.with_planar(Pose2::new(x_m, y_m, yaw_rad))),
        [x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad] => {
            Ok(CameraPose { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad })
        }
        _ => Err(PyValueError::new_err(format!(
            "pose: has {} numbers: give x_m, y_m, yaw_rad, or these and height_m, pitch_rad, roll_rad",
            numbers.len()
        ))),
    }
}

/// Returns the numbers of a pose.
pub fn numbers(pose: CameraPose) -> Numbers {
    (pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m, pose.pitch_rad, pose.roll_rad)
}
