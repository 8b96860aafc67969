//! How a point in the camera's axes moves with the numbers of the camera's pose.

use glam::{DMat3, DVec3};
use nalgebra::Vector6;

use super::picture::moved;
use crate::pose::CameraPose;

/// Half the width of the central differences, metres and radians: their error, a square of it, is that of rounding.
const STEP: f64 = 1e-5;

/// Derivatives of the transform from the world to the camera's axes by x, y, yaw, height, pitch and roll.
pub(super) struct PoseDerivatives([(DMat3, DVec3); 6]);

impl PoseDerivatives {
    /// Differentiates the transform at a pose.
    pub fn at(pose: CameraPose) -> Self {
        let transform = |axis: usize, step: f64| {
            let pose = moved(pose, &(Vector6::ith(axis, step)));
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
