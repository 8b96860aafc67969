//! Conversion of poses to the rigid transforms of nalgebra and back.
//!
//! A pose is the transform that takes coordinates of its own frame to the world: `world_from_camera` for a
//! [`CameraPose`], whose axes are right, down and forward; for a [`Pose2`] the x axis points along the heading.

use glam::{DQuat, DVec3};
use nalgebra::{Isometry2, Isometry3, Quaternion, Translation3, UnitQuaternion, Vector2};

use crate::pose::{CameraPose, Pose2};

/// Returns the transform `world_from_camera`, metres.
impl From<CameraPose> for Isometry3<f64> {
    fn from(pose: CameraPose) -> Self {
        let DQuat { x, y, z, w } = pose.quaternion_world_from_camera();
        let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        Self::from_parts(Translation3::new(pose.x_m, pose.y_m, pose.height_m), rotation)
    }
}

/// Returns the pose with this transform `world_from_camera`, metres; see [`CameraPose::from_world_from_camera`] for a
/// camera that looks straight up or down.
impl From<Isometry3<f64>> for CameraPose {
    fn from(world_from_camera: Isometry3<f64>) -> Self {
        let position = world_from_camera.translation;
        let rotation = world_from_camera.rotation.coords;
        Self::from_world_from_camera(
            DVec3::new(position.x, position.y, position.z),
            DQuat::from_xyzw(rotation.x, rotation.y, rotation.z, rotation.w),
        )
    }
}

/// Returns the transform from the pose's own frame, x along the heading and y to the left, to the world, metres.
impl From<Pose2> for Isometry2<f64> {
    fn from(pose: Pose2) -> Self {
        Self::new(Vector2::new(pose.x_m, pose.y_m), pose.yaw_rad)
    }
}

/// Returns the pose from whose own frame this transform leads to the world, metres; its heading lies in (−π, π].
impl From<Isometry2<f64>> for Pose2 {
    fn from(world_from_pose: Isometry2<f64>) -> Self {
        let position = world_from_pose.translation;
        Self::new(position.x, position.y, world_from_pose.rotation.angle())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::{Point2, Point3};
    use proptest::prelude::*;

    use super::*;
    use crate::pose::wrap_angle;

    fn any_pose() -> impl Strategy<Value = CameraPose> {
        (-10.0..10.0, -7.0..7.0, -PI..PI, 0.1..2.0, -1.5..1.5, -PI..PI)
            .prop_map(|(x, y, yaw, h, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), h, pitch, roll))
    }

    proptest! {
        #[test]
        fn a_camera_pose_survives_the_way_there_and_back(pose in any_pose()) {
            let again = CameraPose::from(Isometry3::from(pose));
            prop_assert_eq!(again.position_in_world(), pose.position_in_world());
            prop_assert!((again.pitch_rad - pose.pitch_rad).abs() < 1e-9);
            prop_assert!(wrap_angle(again.yaw_rad - pose.yaw_rad).abs() < 1e-9);
            prop_assert!(wrap_angle(again.roll_rad - pose.roll_rad).abs() < 1e-9);
        }

        #[test]
        fn a_planar_pose_survives_the_way_there_and_back(pose in any_pose()) {
            let again = Pose2::from(Isometry2::from(pose.planar()));
            prop_assert_eq!(again.position_in_world(), pose.planar().position_in_world());
            prop_assert!(wrap_angle(again.yaw_rad - pose.yaw_rad).abs() < 1e-12);
        }

        #[test]
        fn the_transform_takes_points_where_the_pose_takes_them(pose in any_pose(), point in any_pose()) {
            let point_in_camera = DVec3::new(point.x_m, point.y_m, point.height_m);
            let [x, y, z] = point_in_camera.to_array();
            let moved = Isometry3::from(pose) * Point3::new(x, y, z);
            let back = pose.camera_from_world(DVec3::new(moved.x, moved.y, moved.z));
            prop_assert!((back - point_in_camera).length() < 1e-9);
        }
    }

    #[test]
    fn forward_of_a_camera_is_z_and_forward_of_a_planar_pose_is_x() {
        let pose = CameraPose { yaw_rad: PI / 2.0, height_m: 0.5, ..CameraPose::default() };
        let ahead = Isometry3::from(pose) * Point3::new(0.0, 0.0, 1.0);
        assert!((ahead - Point3::new(0.0, 1.0, 0.5)).norm() < 1e-12, "{ahead}");
        let ahead = Isometry2::from(pose.planar()) * Point2::new(1.0, 0.0);
        assert!((ahead - Point2::new(0.0, 1.0)).norm() < 1e-12, "{ahead}");
    }
}
