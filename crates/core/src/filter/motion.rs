//! Motion model: how particles move from one picture to the next.

use serde::{Deserialize, Serialize};

use crate::{pose::Motion2, setters::setters};

/// Noise of the motion between two pictures: standard deviations that grow with the motion (Thrun, Burgard and Fox,
/// "Probabilistic Robotics", 2005, section 5.4, in the frame of the camera).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct MotionNoise {
    /// Position noise while standing still, 0.02 m: the camera of a humanoid sways with every step.
    pub still_m: f64,
    /// Heading noise while standing still, 0.02 rad.
    pub still_rad: f64,
    /// Position noise, 0.15 m per metre moved: feet slip.
    pub m_per_m: f64,
    /// Heading noise, 0.1 rad per radian turned.
    pub rad_per_rad: f64,
    /// Heading noise, 0.05 rad per metre moved.
    pub rad_per_m: f64,
    /// Position noise between two pictures without odometry, 0.06 m: the paper's prediction, for a robot that walks 0.3 m/s
    /// and takes five pictures a second.
    pub unknown_m: f64,
    /// Heading noise between two pictures without odometry, 0.12 rad: it turns 0.6 rad/s.
    pub unknown_rad: f64,
}

setters!(MotionNoise {
    with_still_m: still_m = f64,
    with_still_rad: still_rad = f64,
    with_m_per_m: m_per_m = f64,
    with_rad_per_rad: rad_per_rad = f64,
    with_rad_per_m: rad_per_m = f64,
    with_unknown_m: unknown_m = f64,
    with_unknown_rad: unknown_rad = f64,
});

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

/// Standard deviations of position (along each axis) and heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSigma {
    /// Standard deviation of x and of y, metres.
    pub position_m: f64,
    /// Standard deviation of the heading, radians.
    pub yaw_rad: f64,
}

impl PlanarSigma {
    /// Returns the standard deviations of the sum of two independent errors.
    pub fn plus(self, other: Self) -> Self {
        Self {
            position_m: self.position_m.hypot(other.position_m),
            yaw_rad: self.yaw_rad.hypot(other.yaw_rad),
        }
    }
}

impl MotionNoise {
    /// Returns the noise of a motion; `None` stands for a motion that was not measured.
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
