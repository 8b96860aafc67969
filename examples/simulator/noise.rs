//! Errors of the robot's sensors and legs, the same for the same seed.

use reality_sim::filter::{Purpose, Stream};

/// Standard deviation of the pitch and of the roll by IMU, radians: that of the demonstration walk against its ground truth.
pub const IMU_RAD: f64 = 0.003;
/// Standard deviations of the odometry after one second, metres and radians: those of the walk's motions from picture to
/// picture (2.7 mm and 0.28° in 0.2 s), which add up as independent errors do.
pub const ODOMETRY_M: f64 = 0.006;
pub const ODOMETRY_RAD: f64 = 0.011;
/// Standard deviation of the share by which the odometry is constantly wrong. The walk has no such error; shoes and carpets
/// bring some per cent.
pub const ODOMETRY_SCALE: f64 = 0.02;
/// Standard deviation of the share by which legs are constantly slower or faster than commanded.
pub const SLIP: f64 = 0.05;
/// Standard deviations of where a person places the robot at the start, metres and radians.
pub const PLACED_M: f64 = 0.02;
pub const PLACED_RAD: f64 = 0.03;

/// What random numbers are drawn for: each use has numbers of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// What stays the same for a whole run.
    Constant,
    /// The start of the run.
    Start,
    /// Odometry of a picture.
    Odometry,
    /// IMU at a picture.
    Imu,
}

/// Source of random numbers.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    seed: u64,
}

impl Noise {
    /// Makes the source of a seed.
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Returns six independent standard normal numbers for a picture, counted from 0.
    pub fn normals(self, purpose: Use, picture: u32) -> [f64; 6] {
        self.stream(purpose, picture).normals(0)
    }

    /// Returns a number from 0 to below 1 for the run's start.
    pub fn start(self) -> f64 {
        self.stream(Use::Start, 0).uniform(0)
    }

    fn stream(self, purpose: Use, picture: u32) -> Stream {
        Stream::new(self.seed, Purpose::Dataset, picture, purpose as u32)
    }
}
