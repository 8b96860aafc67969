//! Where the camera sits and looks, against what a recording's other files state of it: `[mount.correction]` in
//! `camera.toml`.

use std::path::Path;

use glam::{DMat3, DQuat, DVec2, DVec3, EulerRot};
use serde::{Deserialize, Serialize};

use super::{FrameRecord, error::SequenceError, toml_text::NumberCheck, tum::StampedPose};
use crate::{
    mount::MountPose,
    pose::{CameraPose, Pose2},
};

/// Lengths and angles below which two placements differ by rounding only, metres and radians.
const ROUNDING: f64 = 1e-7;

/// Placement of the camera against the poses that `frames.csv` and the reference poses state: pitch and roll of the former,
/// all of the latter. The default changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Mounting {
    /// Height above the reference pose, metres. The height of the mount itself contains it already.
    pub raised_m: f64,
    /// Distance ahead of the reference pose, along its heading, metres.
    pub forward_m: f64,
    /// Distance to the left of the reference pose, across its heading, metres.
    pub left_m: f64,
    /// Turn about the vertical axis against the reference pose, counter-clockwise, radians.
    pub heading_rad: f64,
    /// Turn about the camera's x axis, down is positive, radians; first of three turns about the camera's own axes.
    pub pitch_rad: f64,
    /// Turn about the camera's y axis, to the right is positive, radians.
    pub pan_rad: f64,
    /// Turn about the camera's optical axis, clockwise (seen from behind the camera) is positive, radians.
    pub roll_rad: f64,
}

impl Mounting {
    /// Whether the camera is where the files state it to be.
    pub fn is_as_stated(self) -> bool {
        self == Self::default()
    }

    /// Whether the camera is where the files state it to be, but for rounding.
    pub fn is_nearly_as_stated(self) -> bool {
        let Self { raised_m, forward_m, left_m, heading_rad, pitch_rad, pan_rad, roll_rad } = self;
        [raised_m, forward_m, left_m, heading_rad, pitch_rad, pan_rad, roll_rad]
            .into_iter()
            .all(|value| value.abs() < ROUNDING)
    }

    /// Returns the mounting that turns the camera about its own axes by a rotation, stated from true.
    pub fn turned(stated_from_true: DQuat) -> Self {
        let (x_rad, pan_rad, roll_rad) = stated_from_true.to_euler(EulerRot::XYZ);
        Self { pitch_rad: -x_rad, pan_rad, roll_rad, ..Self::default() }
    }

    /// Returns the turns about the camera's own axes as one rotation.
    pub fn stated_from_true(self) -> DQuat {
        DQuat::from_euler(EulerRot::XYZ, -self.pitch_rad, self.pan_rad, self.roll_rad)
    }

    /// Returns the true pose of the camera for a stated one.
    pub fn pose(self, stated: CameraPose) -> CameraPose {
        let aside = DVec2::from_angle(stated.yaw_rad).rotate(DVec2::new(self.forward_m, self.left_m));
        let rotation = DQuat::from_mat3(&DMat3::from_rotation_z(self.heading_rad))
            * stated.quaternion_world_from_camera()
            * self.stated_from_true();
        let position = stated.position_in_world() + aside.extend(self.raised_m);
        CameraPose::from_world_from_camera(position, rotation)
    }

    /// Returns the true pitch and roll for stated ones; the height stays.
    pub fn mount_pose(self, stated: MountPose) -> MountPose {
        let turn = Self::turned(self.stated_from_true());
        MountPose::of(turn.pose(stated.at(Pose2::default())))
    }

    /// Returns this mounting followed by another one, which takes what this one makes true for stated.
    pub fn then(self, next: Self) -> Self {
        let aside = DVec2::from_angle(self.heading_rad).rotate(DVec2::new(next.forward_m, next.left_m));
        Self {
            raised_m: self.raised_m + next.raised_m,
            forward_m: self.forward_m + aside.x,
            left_m: self.left_m + aside.y,
            heading_rad: self.heading_rad + next.heading_rad,
            ..Self::turned(self.stated_from_true() * next.stated_from_true())
        }
    }

    /// Returns the mounting by which a function takes stated poses to true ones; `None` where none does.
    pub fn of_poses(true_of_stated: impl Fn(CameraPose) -> CameraPose) -> Option<Self> {
        let at = |yaw_rad, pitch_rad, roll_rad| CameraPose {
            yaw_rad,
            pitch_rad,
            roll_rad,
            height_m: 1.0,
            ..CameraPose::default()
        };
        // Between two poses with different pitch, the true camera turns about the horizontal axis that the heading turns.
        let (level, lowered) = (at(0.0, 0.0, 0.0), at(0.0, 0.5, 0.0));
        let turn = true_of_stated(lowered).quaternion_world_from_camera()
            * true_of_stated(level).quaternion_world_from_camera().inverse();
        // Both signs of a quaternion are one turn; that with a positive real part turns by less than half.
        let axis = turn.xyz() * turn.w.signum();
        let mounted = true_of_stated(level);
        let offset = mounted.position_in_world() - level.position_in_world();
        let heading_rad = (-axis.x).atan2(axis.y);
        let unheaded = DQuat::from_rotation_z(-heading_rad) * mounted.quaternion_world_from_camera();
        let found = Self {
            raised_m: offset.z,
            forward_m: offset.x,
            left_m: offset.y,
            heading_rad,
            ..Self::turned(level.quaternion_world_from_camera().inverse() * unheaded)
        };
        let is_alike = |stated: CameraPose| {
            let (given, made) = (true_of_stated(stated), found.pose(stated));
            let points = [DVec3::ZERO, DVec3::X, DVec3::Z];
            points.iter().all(|&point| {
                (given.camera_from_world(point) - made.camera_from_world(point)).length() < ROUNDING
            })
        };
        let found_or_none = if found.is_nearly_as_stated() { Self::default() } else { found };
        [at(1.0, 0.3, 0.2), at(-2.0, 0.1, -0.4)].into_iter().all(is_alike).then_some(found_or_none)
    }

    /// Corrects a reference pose between frames.
    pub(super) fn correct_pose(self, stamped: &mut StampedPose) {
        stamped.pose = self.pose(stamped.pose);
    }

    /// Corrects what a recording states of a frame.
    pub(super) fn correct(self, frame: &mut FrameRecord) {
        let stated = MountPose { height_m: 1.0, pitch_rad: frame.pitch_rad, roll_rad: frame.roll_rad };
        let MountPose { pitch_rad, roll_rad, .. } = self.mount_pose(stated);
        (frame.pitch_rad, frame.roll_rad) = (pitch_rad, roll_rad);
        frame.reference_pose = frame.reference_pose.map(|pose| self.pose(pose));
    }

    /// Refuses numbers that are not finite.
    pub(super) fn check(self, path: &Path, text: &str) -> Result<(), SequenceError> {
        let numbers = NumberCheck { path, text, table: "mount" };
        let Self { raised_m, forward_m, left_m, heading_rad, pitch_rad, pan_rad, roll_rad } = self;
        for value in [raised_m, forward_m, left_m, heading_rad, pitch_rad, pan_rad, roll_rad] {
            numbers.check("correction", value, |_| true, "a table of finite numbers")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn mountings() -> impl Strategy<Value = Mounting> {
        let (length, angle) = (-0.2..0.2_f64, -0.2..0.2_f64);
        (length.clone(), length.clone(), length, angle.clone(), angle.clone(), angle.clone(), angle).prop_map(
            |(raised_m, forward_m, left_m, heading_rad, pitch_rad, pan_rad, roll_rad)| Mounting {
                raised_m,
                forward_m,
                left_m,
                heading_rad,
                pitch_rad,
                pan_rad,
                roll_rad,
            },
        )
    }

    fn distance(a: CameraPose, b: CameraPose) -> f64 {
        (a.position_in_world() - b.position_in_world()).length()
            + a.quaternion_world_from_camera().angle_between(b.quaternion_world_from_camera())
    }

    proptest! {
        #[test]
        fn a_mounting_is_known_from_the_poses_that_it_makes(mounting in mountings()) {
            let found = Mounting::of_poses(|pose| mounting.pose(pose)).unwrap();
            let stated = CameraPose::new(Pose2::new(1.0, 2.0, 0.7), 0.5, 0.4, -0.1);
            prop_assert!(distance(found.pose(stated), mounting.pose(stated)) < 1e-6);
            prop_assert!((found.heading_rad - mounting.heading_rad).abs() < 1e-9);
        }

        #[test]
        fn pitch_and_roll_of_the_mount_are_those_of_the_pose(mounting in mountings(), pitch_rad in -0.2..0.8_f64) {
            let stated = CameraPose::new(Pose2::new(1.0, 2.0, 0.7), 0.5, pitch_rad, 0.05);
            let (mount, pose) = (mounting.mount_pose(MountPose::of(stated)), mounting.pose(stated));
            prop_assert!((mount.pitch_rad - pose.pitch_rad).abs() < 1e-9);
            prop_assert!((mount.roll_rad - pose.roll_rad).abs() < 1e-9);
            prop_assert!((mount.height_m - 0.5).abs() < 1e-12);
        }

        #[test]
        fn turns_follow_each_other(first in mountings(), second in mountings()) {
            let turn = |mounting: Mounting| Mounting { pan_rad: 0.0, roll_rad: 0.0, pitch_rad: mounting.pitch_rad, ..mounting };
            let (first, second) = (turn(first), turn(second));
            let stated = CameraPose::new(Pose2::new(1.0, 2.0, 0.7), 0.5, 0.4, 0.0);
            let both = second.pose(first.pose(stated));
            prop_assert!(distance(first.then(second).pose(stated), both) < 1e-6);
        }
    }

    #[test]
    fn a_positive_pitch_looks_lower_and_a_positive_roll_turns_clockwise() {
        let stated = CameraPose::new(Pose2::default(), 0.5, 0.3, 0.0);
        let lower = Mounting { pitch_rad: 0.1, ..Mounting::default() }.pose(stated);
        assert!((lower.pitch_rad - 0.4).abs() < 1e-12 && lower.roll_rad.abs() < 1e-12);
        let turned = Mounting { roll_rad: 0.1, ..Mounting::default() }.pose(stated);
        assert!((turned.roll_rad - 0.1).abs() < 1e-12 && (turned.pitch_rad - 0.3).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_mounting_is_none() {
        let twice = |pose: CameraPose| CameraPose { height_m: 2.0 * pose.height_m + pose.yaw_rad, ..pose };
        assert_eq!(Mounting::of_poses(twice), None);
        assert!(Mounting::of_poses(|pose| pose).unwrap().pose(CameraPose::default()).height_m.abs() < 1e-12);
    }
}
