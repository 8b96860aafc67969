//! Steps of a pose in its six numbers, and how a point in the camera's axes moves with them.

use glam::{DMat3, DVec3};
use nalgebra::Vector6;

use crate::pose::{CameraPose, wrap_angle};

/// Half the width of the central differences, metres and radians: their error, a square of it, is that of rounding.
const STEP: f64 = 1e-5;

/// Returns the pose moved by a step in x, y, yaw, height, pitch and roll, metres and radians.
pub fn moved(pose: CameraPose, step: &Vector6<f64>) -> CameraPose {
    CameraPose {
        x_m: pose.x_m + step[0],
        y_m: pose.y_m + step[1],
        yaw_rad: wrap_angle(pose.yaw_rad + step[2]),
        height_m: pose.height_m + step[3],
        pitch_rad: pose.pitch_rad + step[4],
        roll_rad: pose.roll_rad + step[5],
    }
}

/// Returns the step in x, y, yaw, height, pitch and roll from one pose to another, metres and radians.
pub fn pose_difference(from: CameraPose, to: CameraPose) -> Vector6<f64> {
    Vector6::new(
        to.x_m - from.x_m,
        to.y_m - from.y_m,
        wrap_angle(to.yaw_rad - from.yaw_rad),
        to.height_m - from.height_m,
        to.pitch_rad - from.pitch_rad,
        wrap_angle(to.roll_rad - from.roll_rad),
    )
}

/// Derivatives of the transform from the world to the camera's axes by x, y, yaw, height, pitch and roll.
pub(super) struct PoseDerivatives([(DMat3, DVec3); 6]);

impl PoseDerivatives {
    /// Differentiates the transform at a pose.
    pub fn at(pose: CameraPose) -> Self {
        let transform = |axis: usize, step: f64| {
            let pose = moved(pose, &Vector6::ith(axis, step));
            let camera_from_world = pose.rotation_world_from_camera().transpose();
            (camera_from_world, -(camera_from_world * pose.position_in_world()))
        };
        Self(std::array::from_fn(|axis| {
            let (after, before) = (transform(axis, STEP), transform(axis, -STEP));
            let per_unit = 1.0 / (2.0 * STEP);
            ((after.0 - before.0) * per_unit, (after.1 - before.1) * per_unit)
        }))
    }

    /// Returns the derivatives of a point of the world in the camera's axes, metres per metre and per radian.
    pub fn of_point(&self, point_in_world: DVec3) -> [DVec3; 6] {
        self.0.map(|(rotation, translation)| rotation * point_in_world + translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scene;

    /// The truth are differences of the point itself, and for the position the camera's axes.
    #[test]
    fn derivatives_are_the_change_of_the_point() {
        let point = DVec3::new(1.3, -0.7, 0.2);
        for pose in test_scene::poses() {
            let derivatives = PoseDerivatives::at(pose).of_point(point);
            for (axis, derivative) in derivatives.into_iter().enumerate() {
                let at = |step: f64| moved(pose, &Vector6::ith(axis, step)).camera_from_world(point);
                let change = (at(1e-4) - at(-1e-4)) / 2e-4;
                assert!(derivative.distance(change) < 1e-7, "{axis}: {derivative} instead of {change}");
            }
            let axes = pose.rotation_world_from_camera().transpose();
            for (number, axis) in [(0, axes.x_axis), (1, axes.y_axis), (3, axes.z_axis)] {
                assert!(derivatives[number].distance(-axis) < 1e-9, "{number}");
            }
        }
    }
}
