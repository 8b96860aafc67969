//! Poses on the field, and the rotation convention on which everything else is built.
//!
//! | frame | origin | axes |
//! |---|---|---|
//! | world | the field's centre, on the carpet | x towards the opponent's goal, y left, z up (REP-103) |
//! | camera | the projection centre | x right, y down, z into the scene (OpenCV) |
//!
//! A transform is named `to_from_from`: `world_from_camera` takes camera coordinates and gives world ones.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DQuat, DVec2, DVec3};

/// Maximum distance of a camera from the field's centre, metres: the largest field is 200 m long.
pub const FARTHEST_M: f64 = 200.0;

/// Wraps an angle in radians to (−π, π].
pub fn wrap_angle(angle_rad: f64) -> f64 {
    let wrapped = (angle_rad + PI).rem_euclid(TAU) - PI;
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

/// Planar pose: a position above the field and the heading of the optical axis.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose2 {
    /// Position towards the opponent's goal, metres from the field's centre.
    pub x_m: f64,
    /// Position to the left, metres from the field's centre.
    pub y_m: f64,
    /// Heading, counter-clockwise from +x, radians.
    pub yaw_rad: f64,
}

impl Pose2 {
    /// Makes a pose from its coordinates.
    pub fn new(x_m: f64, y_m: f64, yaw_rad: f64) -> Self {
        Self { x_m, y_m, yaw_rad }
    }

    /// Returns the position in the world, metres.
    pub fn position_in_world(self) -> DVec2 {
        DVec2::new(self.x_m, self.y_m)
    }

    /// Returns the motion, in this pose's own frame, that leads from this pose to `next`.
    pub fn motion_to(self, next: Self) -> Motion2 {
        let delta =
            DVec2::from_angle(-self.yaw_rad).rotate(next.position_in_world() - self.position_in_world());
        Motion2 { forward_m: delta.x, left_m: delta.y, turn_rad: wrap_angle(next.yaw_rad - self.yaw_rad) }
    }

    /// Returns the pose reached by a motion given in this pose's own frame.
    pub fn moved(self, motion: Motion2) -> Self {
        let delta = DVec2::from_angle(self.yaw_rad).rotate(DVec2::new(motion.forward_m, motion.left_m));
        Self {
            x_m: self.x_m + delta.x,
            y_m: self.y_m + delta.y,
            yaw_rad: wrap_angle(self.yaw_rad + motion.turn_rad),
        }
    }

    /// Returns the mirror pose, turned by 180° about the field's centre. A field with equal halves looks the same from
    /// both.
    pub fn mirrored(self) -> Self {
        Self { x_m: -self.x_m, y_m: -self.y_m, yaw_rad: wrap_angle(self.yaw_rad + PI) }
    }
}

/// Planar motion between two poses, in the frame of the first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion2 {
    /// Distance along the heading, metres.
    pub forward_m: f64,
    /// Distance to the left of the heading, metres.
    pub left_m: f64,
    /// Change of heading, counter-clockwise, radians.
    pub turn_rad: f64,
}

impl Motion2 {
    /// Returns the straight-line distance, metres.
    pub fn distance_m(self) -> f64 {
        self.forward_m.hypot(self.left_m)
    }
}

/// Pose of a camera in the world.
///
/// With yaw ψ, pitch θ (depression of the optical axis, down is positive) and roll φ (clockwise seen from behind):
/// `forward = (cos ψ cos θ, sin ψ cos θ, −sin θ)`, `right₀ = (sin ψ, −cos ψ, 0)`, `down₀ = forward × right₀`, `right =
/// cos φ right₀ + sin φ down₀`, `down = −sin φ right₀ + cos φ down₀`.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraPose {
    /// Position towards the opponent's goal, metres from the field's centre.
    pub x_m: f64,
    /// Position to the left, metres from the field's centre.
    pub y_m: f64,
    /// Heading of the optical axis, counter-clockwise from +x, radians.
    pub yaw_rad: f64,
    /// Height above the carpet, metres.
    pub height_m: f64,
    /// Depression of the optical axis below the horizon, radians.
    pub pitch_rad: f64,
    /// Roll about the optical axis, clockwise seen from behind the camera, radians.
    pub roll_rad: f64,
}

impl CameraPose {
    /// Lifts a planar pose to a height, with the camera's pitch and roll.
    pub fn new(planar: Pose2, height_m: f64, pitch_rad: f64, roll_rad: f64) -> Self {
        Self { x_m: planar.x_m, y_m: planar.y_m, yaw_rad: planar.yaw_rad, height_m, pitch_rad, roll_rad }
    }

    /// Returns the planar part of the pose.
    pub fn planar(self) -> Pose2 {
        Pose2 { x_m: self.x_m, y_m: self.y_m, yaw_rad: self.yaw_rad }
    }

    /// Returns the same camera at another place and heading.
    pub fn with_planar(self, planar: Pose2) -> Self {
        Self::new(planar, self.height_m, self.pitch_rad, self.roll_rad)
    }

    /// Returns the mirror pose, turned by 180° about the field's centre.
    pub fn mirrored(self) -> Self {
        self.with_planar(self.planar().mirrored())
    }

    /// Returns the projection centre in the world, metres.
    pub fn position_in_world(self) -> DVec3 {
        DVec3::new(self.x_m, self.y_m, self.height_m)
    }

    /// Returns the rotation whose columns are the camera's right, down and forward in the world.
    pub fn rotation_world_from_camera(self) -> DMat3 {
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let (sin_roll, cos_roll) = self.roll_rad.sin_cos();
        let forward = DVec3::new(cos_yaw * cos_pitch, sin_yaw * cos_pitch, -sin_pitch);
        let right_0 = DVec3::new(sin_yaw, -cos_yaw, 0.0);
        let down_0 = forward.cross(right_0);
        let right = cos_roll * right_0 + sin_roll * down_0;
        let down = -sin_roll * right_0 + cos_roll * down_0;
        DMat3::from_cols(right, down, forward)
    }

    /// Transforms a point from the world to the camera's axes, metres.
    pub fn camera_from_world(self, point_in_world: DVec3) -> DVec3 {
        self.rotation_world_from_camera().transpose() * (point_in_world - self.position_in_world())
    }

    /// Returns the pose of a camera at `position_in_world` with this rotation. If it looks straight up or down, so that
    /// yaw and roll turn about the same axis, the roll is taken as zero.
    pub fn from_world_from_camera(position_in_world: DVec3, rotation_world_from_camera: DQuat) -> Self {
        let rotation = DMat3::from_quat(rotation_world_from_camera);
        let (right, forward) = (rotation.x_axis, rotation.z_axis);
        let horizontal = forward.x.hypot(forward.y);
        let pitch_rad = (-forward.z).atan2(horizontal);
        let (yaw_rad, roll_rad) = if horizontal > 1e-9 {
            let yaw_rad = forward.y.atan2(forward.x);
            let right_0 = DVec3::new(yaw_rad.sin(), -yaw_rad.cos(), 0.0);
            (yaw_rad, right.dot(forward.cross(right_0)).atan2(right.dot(right_0)))
        } else {
            (right.x.atan2(-right.y), 0.0)
        };
        Self {
            x_m: position_in_world.x,
            y_m: position_in_world.y,
            yaw_rad: wrap_angle(yaw_rad),
            height_m: position_in_world.z,
            pitch_rad,
            roll_rad,
        }
    }

    /// Returns the rotation as a unit quaternion, world from camera, as TUM files store it.
    pub fn quaternion_world_from_camera(self) -> DQuat {
        DQuat::from_mat3(&self.rotation_world_from_camera())
    }

    /// Returns whether a camera above a field can have this pose: finite, above the ground, and no farther than
    /// [`FARTHEST_M`] from the field's centre.
    pub fn is_possible(self) -> bool {
        self.is_finite() && self.height_m > 0.0 && self.position_in_world().length() <= FARTHEST_M
    }

    /// Returns whether every coordinate is a finite number.
    pub fn is_finite(self) -> bool {
        [self.x_m, self.y_m, self.yaw_rad, self.height_m, self.pitch_rad, self.roll_rad]
            .iter()
            .all(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_pose() -> impl Strategy<Value = CameraPose> {
        (-10.0..10.0, -7.0..7.0, -PI..PI, 0.1..2.0, -1.5..1.5, -PI..PI)
            .prop_map(|(x, y, yaw, h, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), h, pitch, roll))
    }

    #[test]
    fn level_camera_has_the_axes_of_the_convention() {
        let rotation = CameraPose::default().rotation_world_from_camera();
        assert_eq!(rotation.x_axis, DVec3::new(0.0, -1.0, 0.0), "right is −y");
        assert_eq!(rotation.y_axis, DVec3::new(0.0, 0.0, -1.0), "down is −z");
        assert_eq!(rotation.z_axis, DVec3::new(1.0, 0.0, 0.0), "forward is +x");
    }

    #[test]
    fn positive_pitch_looks_down_and_positive_roll_turns_right_towards_down() {
        let down = CameraPose { pitch_rad: 0.3, ..Default::default() };
        assert!(down.rotation_world_from_camera().z_axis.z < 0.0);
        let rolled = CameraPose { roll_rad: 0.3, ..Default::default() };
        assert!(rolled.rotation_world_from_camera().x_axis.z < 0.0);
    }

    #[test]
    fn straight_down_keeps_its_rotation() {
        let pose = CameraPose { yaw_rad: 0.7, pitch_rad: PI / 2.0, ..Default::default() };
        let again =
            CameraPose::from_world_from_camera(pose.position_in_world(), pose.quaternion_world_from_camera());
        let difference = again.rotation_world_from_camera() - pose.rotation_world_from_camera();
        assert!(difference.to_cols_array().iter().all(|value| value.abs() < 1e-6));
    }

    proptest! {
        #[test]
        fn quaternion_round_trip(pose in any_pose()) {
            let again = CameraPose::from_world_from_camera(pose.position_in_world(), pose.quaternion_world_from_camera());
            prop_assert!((again.pitch_rad - pose.pitch_rad).abs() < 1e-9);
            prop_assert!(wrap_angle(again.yaw_rad - pose.yaw_rad).abs() < 1e-9);
            prop_assert!(wrap_angle(again.roll_rad - pose.roll_rad).abs() < 1e-9);
        }

        #[test]
        fn rotation_is_proper(pose in any_pose()) {
            let rotation = pose.rotation_world_from_camera();
            prop_assert!((rotation.determinant() - 1.0).abs() < 1e-12);
        }

        #[test]
        fn motion_and_moved_are_inverse(a in any_pose(), b in any_pose()) {
            let (a, b) = (a.planar(), b.planar());
            let reached = a.moved(a.motion_to(b));
            prop_assert!((reached.position_in_world() - b.position_in_world()).length() < 1e-9);
            prop_assert!(wrap_angle(reached.yaw_rad - b.yaw_rad).abs() < 1e-9);
        }

        #[test]
        fn wrapped_angles_are_in_range(angle in -1e4..1e4) {
            let wrapped = wrap_angle(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            prop_assert!(((wrapped - angle) / TAU - ((wrapped - angle) / TAU).round()).abs() < 1e-9);
        }
    }
}
