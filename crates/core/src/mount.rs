//! Mounting of the camera: height, pitch and roll as measured by joints and IMU, and their uncertainty.

use nalgebra::{Matrix6, Vector6};

use crate::pose::{CameraPose, Pose2, wrap_angle};

/// Height, pitch and roll of the camera over the ground by joints and IMU, whatever its place and heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MountPose {
    /// Height above the carpet, metres.
    pub height_m: f64,
    /// Depression of the optical axis, radians.
    pub pitch_rad: f64,
    /// Roll about the optical axis, clockwise seen from behind the camera, radians.
    pub roll_rad: f64,
}

impl MountPose {
    /// Returns height, pitch and roll of a pose.
    pub fn of(pose: CameraPose) -> Self {
        Self { height_m: pose.height_m, pitch_rad: pose.pitch_rad, roll_rad: pose.roll_rad }
    }

    /// Returns the rotation from the camera's axes to x along the heading, y left, z up.
    pub(crate) fn rotation_heading_from_camera(self) -> glam::DMat3 {
        self.at(Pose2::default()).rotation_world_from_camera()
    }

    /// Returns the pose of a camera mounted like this at a planar pose.
    pub fn at(self, planar: Pose2) -> CameraPose {
        CameraPose::new(planar, self.height_m, self.pitch_rad, self.roll_rad)
    }
}

/// Standard deviations of a [`MountPose`] by joints and IMU.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MountPoseSigma {
    /// Standard deviation of the height, 0.03 m by default: a humanoid's knees bend by that much in a step.
    pub height_m: f64,
    /// Standard deviation of pitch and of roll, 0.01 rad by default: half a degree, for an inexpensive IMU and the play of
    /// joints.
    pub angle_rad: f64,
}

impl Default for MountPoseSigma {
    fn default() -> Self {
        Self { height_m: 0.03, angle_rad: 0.01 }
    }
}

impl MountPoseSigma {
    /// Returns the inverse covariance that joints and IMU give the six numbers of a pose.
    pub(crate) fn information(&self) -> Matrix6<f64> {
        let [height, angle] = [self.height_m, self.angle_rad].map(|sigma| 1.0 / (sigma * sigma));
        Matrix6::from_diagonal(&Vector6::new(0.0, 0.0, 0.0, height, angle, angle))
    }

    /// Returns the log-probability, up to a constant, of a pose's height, pitch and roll, given the mount pose.
    pub fn log_prior(&self, pose: CameraPose, mount: MountPose) -> f64 {
        let height = (pose.height_m - mount.height_m) / self.height_m;
        let pitch = (pose.pitch_rad - mount.pitch_rad) / self.angle_rad;
        let roll = wrap_angle(pose.roll_rad - mount.roll_rad) / self.angle_rad;
        -0.5 * (height * height + pitch * pitch + roll * roll)
    }
}
