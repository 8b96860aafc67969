//! Poses.

use reality_sim::CameraPose;

use crate::status::Failure;

/// Pose of a camera in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Pose {
    /// Place, metres.
    pub x_m: f64,
    /// Place, metres.
    pub y_m: f64,
    /// Heading, radians, counterclockwise from the x axis.
    pub yaw_rad: f64,
    /// Height above the ground, metres.
    pub height_m: f64,
    /// Pitch, radians, positive downwards.
    pub pitch_rad: f64,
    /// Roll, radians, positive clockwise as seen from behind the camera.
    pub roll_rad: f64,
}

impl From<CameraPose> for Pose {
    fn from(pose: CameraPose) -> Self {
        let CameraPose { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad } = pose;
        Self { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad }
    }
}

impl TryFrom<Pose> for CameraPose {
    type Error = Failure;

    fn try_from(pose: Pose) -> Result<Self, Self::Error> {
        let Pose { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad } = pose;
        match [x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad].iter().all(|number| number.is_finite()) {
            true => Ok(Self { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad }),
            false => {
                Err(Failure::argument("pose: holds a number that is not finite: give metres and radians"))
            }
        }
    }
}
