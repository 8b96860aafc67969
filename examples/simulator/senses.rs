//! What passes between the robot and the world: all that the robot senses, and all that it can do.

use std::sync::Arc;

use reality_sim::{Pose2, image::RgbImage, mount::MountPose};

/// What the robot senses when a picture is taken.
#[derive(Debug, Clone)]
pub struct Senses {
    /// Time, seconds.
    pub time_s: f64,
    /// Picture of its camera.
    pub picture: Arc<RgbImage>,
    /// How the camera is held, by joints and IMU.
    pub mount: MountPose,
    /// Where its steps have led it, in the frame in which it was switched on.
    pub odometry: Pose2,
}

/// Velocity that the robot wants to walk with.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Velocity along its heading, metres per second.
    pub forward_m_s: f64,
    /// Velocity to its left, metres per second.
    pub left_m_s: f64,
    /// Turning rate, counter-clockwise, radians per second.
    pub turn_rad_s: f64,
}

impl Command {
    /// Returns the motion of some seconds with this velocity, without slip.
    pub fn pose_after(self, from: Pose2, seconds: f64) -> Pose2 {
        /// Number of straight pieces that stand for the arc: at 1 rad/s for 1 s they are 1 % beside it.
        const PIECES: u32 = 4;
        let piece_s = seconds / f64::from(PIECES);
        (0..PIECES).fold(from, |pose, _| {
            pose.moved(reality_sim::pose::Motion2 {
                forward_m: self.forward_m_s * piece_s,
                left_m: self.left_m_s * piece_s,
                turn_rad: self.turn_rad_s * piece_s,
            })
        })
    }
}
