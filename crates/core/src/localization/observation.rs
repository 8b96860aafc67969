//! What a robot observes at one time.

use super::picture::Picture;
use crate::{mount::MountPose, pose::Pose2, sequence::Sequence};

/// A picture and what the robot knew when it was taken.
#[derive(Debug, Clone)]
pub struct Observation {
    /// Time at which the picture was taken, by any clock, seconds.
    pub timestamp_s: f64,
    /// Picture of the camera's size.
    pub picture: Picture,
    /// Pose by dead reckoning in the odometry's own frame; `None` without odometry.
    pub odometry: Option<Pose2>,
    /// Mount pose by joints and IMU.
    pub mount: MountPose,
}

impl Observation {
    /// Makes an observation without odometry.
    pub fn new(timestamp_s: f64, picture: impl Into<Picture>, mount: MountPose) -> Self {
        Self { timestamp_s, picture: picture.into(), odometry: None, mount }
    }

    /// Adds the pose by dead reckoning, in the odometry's own frame.
    pub fn with_odometry(self, odometry: Pose2) -> Self {
        Self { odometry: Some(odometry), ..self }
    }

    /// Makes an observation from the record of a frame (counted from 0) and its picture.
    ///
    /// # Panics
    ///
    /// If the recording has no such frame.
    pub fn of_frame(sequence: &Sequence, index: usize, picture: impl Into<Picture>) -> Self {
        let record = &sequence.frames[index];
        let mount = mount_of_frame(sequence, index);
        Self { odometry: record.odometry, ..Self::new(record.timestamp_s, picture, mount) }
    }
}

/// Returns the mount pose at a frame (counted from 0): the recording's camera height, and the frame's own pitch and roll.
///
/// # Panics
///
/// If the recording has no such frame.
pub fn mount_of_frame(sequence: &Sequence, index: usize) -> MountPose {
    let record = &sequence.frames[index];
    MountPose {
        height_m: sequence.setup.mount_height_m,
        pitch_rad: record.pitch_rad,
        roll_rad: record.roll_rad,
    }
}
