//! How particles move from one picture to the next.

use serde::{Deserialize, Serialize};

use crate::pose::Motion2;

/// Noise of the motion between two pictures: standard deviations that grow with the motion (Thrun, Burgard and Fox,
/// "Probabilistic Robotics", 2005, section 5.4, in the frame of the camera).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MotionNoise {
    /// Of the place, standing still, metres: the camera sways with every step.
    pub still_m: f64,
    /// Of the heading, standing still, radians.
    pub still_rad: f64,
    /// Of the place, per metre moved.
    pub m_per_m: f64,
    /// Of the heading, per radian turned.
    pub rad_per_rad: f64,
    /// Of the heading, radians per metre moved.
    pub rad_per_m: f64,
    /// Of the place between two pictures where no odometry is used, metres: the paper's prediction.
    pub unknown_m: f64,
    /// Of the heading between two pictures where no odometry is used, radians.
    pub unknown_rad: f64,
}

impl Default for MotionNoise {
    fn default() -> Self {
        Self {
            still_m: 0.02,
            still_rad: 0.02,
            m_per_m: 0.15,
            rad_per_rad: 0.1,
            rad_per_m: 0.05,
            unknown_m: 0.06,
            unknown_rad: 0.12,
        }
    }
}

/// Standard deviations of place (each axis) and heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSigma {
    /// Metres.
    pub position_m: f64,
    /// Radians.
    pub yaw_rad: f64,
}

impl PlanarSigma {
    /// Of the sum of two independent errors.
    pub fn plus(self, other: Self) -> Self {
        Self {
            position_m: self.position_m.hypot(other.position_m),
            yaw_rad: self.yaw_rad.hypot(other.yaw_rad),
        }
    }
}

impl MotionNoise {
    /// Noise of a motion; `None` for a motion that nobody measured.
    pub fn sigma(&self, motion: Option<Motion2>) -> PlanarSigma {
        match motion {
            Some(motion) => {
                let (distance_m, turn_rad) = (motion.distance_m(), motion.turn_rad.abs());
                PlanarSigma {
                    position_m: self.still_m + self.m_per_m * distance_m,
                    yaw_rad: self.still_rad + self.rad_per_rad * turn_rad + self.rad_per_m * distance_m,
                }
            }
            None => PlanarSigma { position_m: self.unknown_m, yaw_rad: self.unknown_rad },
        }
    }
}
