//! Axes of frames: a camera's own (x right, y down, z forward, as OpenCV and the ROS frames named `…_optical_frame` have them) or
//! those of a body (x forward, y left, z up, REP-103).

use glam::{DMat3, DQuat, DVec3};
use reality_sim_core::pose::CameraPose;

use crate::message::Rigid;

/// Axes of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// x right, y down, z forward.
    Optical,
    /// x forward, y left, z up.
    Body,
}

impl Axes {
    /// Returns the axes that a frame's name promises.
    pub fn by_name(frame: &str) -> Self {
        let is_optical =
            frame.ends_with("_optical") || frame.ends_with("optical_frame") || frame == "optical";
        if is_optical { Self::Optical } else { Self::Body }
    }

    /// Tells the axes by rotations to a frame whose third axis points up: either the third axis points up, or the second one down.
    /// `None` without rotations.
    pub fn by_data(level_from_frame: impl Iterator<Item = DQuat>) -> Option<Self> {
        let scores = level_from_frame.map(|rotation| -(rotation * DVec3::Y).z - (rotation * DVec3::Z).z);
        let sum = scores.fold(None, |sum: Option<f64>, score| Some(sum.unwrap_or(0.0) + score))?;
        Some(if sum > 0.0 { Self::Optical } else { Self::Body })
    }

    /// Returns the name of the axes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Optical => "optical",
            Self::Body => "body",
        }
    }

    /// Returns the rotation from a camera's own axes to these.
    pub fn rotation_from_optical(self) -> DQuat {
        match self {
            Self::Optical => DQuat::IDENTITY,
            // Right is minus left, down is minus up, forward is forward.
            Self::Body => DQuat::from_mat3(&DMat3::from_cols(-DVec3::Y, -DVec3::Z, DVec3::X)),
        }
    }

    /// Returns the camera's pose that a frame with these axes has.
    pub fn camera_pose(self, world_from_frame: Rigid) -> CameraPose {
        let rotation = world_from_frame.rotation * self.rotation_from_optical();
        CameraPose::from_world_from_camera(world_from_frame.translation, rotation)
    }
}

#[cfg(test)]
mod tests {
    use glam::EulerRot;
    use reality_sim_core::pose::Pose2;

    use super::*;

    /// Roll, pitch and yaw of REP-103 are those of FORMATS: turns about z, then the new y, then the new x. The formulas are those
    /// that define a pose, not the code under test.
    #[test]
    fn roll_and_pitch_of_a_body_are_those_of_the_camera() {
        for (yaw, pitch, roll) in [(0.3_f64, 0.4_f64, 0.1_f64), (-2.0, 0.9, -0.3), (3.0, -0.2, 0.05)] {
            let body = DQuat::from_euler(EulerRot::ZYX, yaw, pitch, roll);
            let forward = DVec3::new(yaw.cos() * pitch.cos(), yaw.sin() * pitch.cos(), -pitch.sin());
            let right_0 = DVec3::new(yaw.sin(), -yaw.cos(), 0.0);
            let down_0 = forward.cross(right_0);
            let right = roll.cos() * right_0 + roll.sin() * down_0;
            let down = -roll.sin() * right_0 + roll.cos() * down_0;
            let optical = body * Axes::Body.rotation_from_optical();
            for (axis, expected) in [(DVec3::X, right), (DVec3::Y, down), (DVec3::Z, forward)] {
                assert!((optical * axis - expected).length() < 1e-12, "{axis}");
            }
            let pose = Axes::Body.camera_pose(Rigid::new(body, DVec3::new(1.0, 2.0, 0.5)));
            assert!((pose.pitch_rad - pitch).abs() < 1e-12 && (pose.roll_rad - roll).abs() < 1e-12);
            assert!((pose.yaw_rad - yaw).abs() < 1e-12 && pose.height_m == 0.5);
        }
    }

    #[test]
    fn axes_are_told_by_which_one_points_up() {
        for (pitch, roll) in [(0.0, 0.0), (0.9, 0.2), (-0.5, -0.3), (1.3, 0.1)] {
            let optical =
                CameraPose::new(Pose2::new(0.0, 0.0, 2.0), 0.5, pitch, roll).quaternion_world_from_camera();
            let body = optical * Axes::Body.rotation_from_optical().inverse();
            assert_eq!(Axes::by_data([optical].into_iter()), Some(Axes::Optical));
            assert_eq!(Axes::by_data([body].into_iter()), Some(Axes::Body));
        }
        assert_eq!(Axes::by_data(std::iter::empty()), None);
        assert_eq!(Axes::by_name("camera_optical_frame"), Axes::Optical);
        assert_eq!(Axes::by_name("imu_link"), Axes::Body);
    }
}
