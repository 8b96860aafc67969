//! What a robot knows at one time.

use super::picture::Picture;
use crate::{mount::MountPose, pose::Pose2, sequence::Sequence};

/// A picture with what the robot knew when it was taken.
#[derive(Debug, Clone)]
pub struct Observation {
    /// When it was taken, by any clock, seconds.
    pub timestamp_s: f64,
    /// The picture; it has the camera's size.
    pub picture: Picture,
    /// Pose by dead reckoning, in a frame of its own, where the robot has odometry.
    pub odometry: Option<Pose2>,
    /// Height, pitch and roll by joints and IMU.
    pub mount: MountPose,
}

impl Observation {
    /// A picture without odometry.
    pub fn new(timestamp_s: f64, picture: impl Into<Picture>, mount: MountPose) -> Self {
        Self { timestamp_s, picture: picture.into(), odometry: None, mount }
    }

    /// With the pose by dead reckoning, in a frame of its own.
    pub fn with_odometry(self, odometry: Pose2) -> Self {
        Self { odometry: Some(odometry), ..self }
    }

    /// A frame of a recording (from 0) with its picture.
    ///
    /// # Panics
    ///
    /// Where the recording has no such frame.
    pub fn of_frame(sequence: &Sequence, index: usize, picture: impl Into<Picture>) -> Self {
        let record = &sequence.frames[index];
        let mount = mount_of_frame(sequence, index);
        Self { odometry: record.odometry, ..Self::new(record.timestamp_s, picture, mount) }
    }
}

/// The mount pose at a frame of a recording (from 0): the height of the camera's mount, pitch and roll of that frame.
///
/// # Panics
///
/// Where the recording has no such frame.
pub fn mount_of_frame(sequence: &Sequence, index: usize) -> MountPose {
    let record = &sequence.frames[index];
    MountPose {
        height_m: sequence.setup.mount_height_m,
        pitch_rad: record.pitch_rad,
        roll_rad: record.roll_rad,
    }
}
