//! Recipe of a recording: a seed, and the effects hidden in the recording.

use crate::{
    drawn::{self, Given},
    effect::Hidden,
    error::Error,
    log::ReferenceErrors,
    random::Random,
    setting::Setting,
    sights,
    trajectory::{Trajectory, Walk},
};

/// Largest number of frames of a recipe.
const MOST_FRAMES: usize = 100_000;
/// Largest width and height of a recipe's pictures, pixels.
const MOST_PIXELS: u32 = 8192;
/// Largest exposure time, readout time and clock offset, seconds.
const LONGEST_S: f64 = 0.5;
/// Number of paths tried for one on which lines are in view.
const PATHS: u64 = 20;

/// Worlds from which a recording comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum World {
    /// A field of 6 × 4 m under even light, a small humanoid with a fisheye, five pictures per second, and nominal values
    /// that are exact: lens, hall and walk differ a little from seed to seed.
    #[default]
    Standard,
    /// Field, hall, carpet, light, paint, lens, sensor, robot and measured nominal values are all drawn anew.
    Drawn,
}

/// Recipe of a recording. Everything not given here is drawn from the seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// Seed of the hall, the camera, the walk and all noise. The same recipe gives the same bytes.
    pub seed: u64,
    /// Number of pictures.
    pub frames: usize,
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
    /// Effects that the files beside the pictures do not mention. Effects of one kind add up.
    pub effects: Vec<Hidden>,
    /// Motion of the robot.
    pub walk: Walk,
    /// World from which the recording comes.
    pub world: World,
    /// What the files of a drawn world tell of brightness, noise and sharpness; none is drawn.
    pub given: Option<Given>,
    /// Number of reference poses per second; none is one for each picture.
    pub reference_rate_hz: Option<f64>,
    /// Whether the reference poses are the true ones, without the errors of motion capture.
    pub exact_references: bool,
}

impl Recipe {
    /// Makes a recipe for 60 pictures of 640 × 480 pixels on a walk in a standard world, with nothing hidden.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            frames: 60,
            size: [640, 480],
            effects: Vec::new(),
            walk: Walk::Walking,
            world: World::Standard,
            given: None,
            reference_rate_hz: None,
            exact_references: false,
        }
    }

    /// Makes the same recipe in a drawn world.
    pub fn drawn(seed: u64) -> Self {
        Self { world: World::Drawn, ..Self::new(seed) }
    }

    pub(crate) fn setting(&self) -> Setting {
        let mut setting = match self.world {
            World::Standard => Setting::standard(self.seed, self.size),
            World::Drawn => drawn::setting(self.seed, self.size, self.given),
        };
        if self.exact_references {
            setting.errors.reference = ReferenceErrors::NONE;
        }
        setting
    }

    /// Draws the path; in drawn worlds one from which lines are seen.
    pub(crate) fn trajectory(&self, setting: &Setting) -> Trajectory {
        let path = |number| {
            let random = &mut Random::stream(self.seed, "trajectory", number);
            let Setting { gait, reach_m, .. } = *setting;
            let duration_s = (self.frames + 1) as f64 / setting.rate_hz;
            Trajectory::new(random, self.walk, gait, duration_s, reach_m, setting.nominal.height_m)
        };
        let times_s: Vec<f64> = (0..self.frames).map(|frame| (frame + 1) as f64 / setting.rate_hz).collect();
        let sees_lines = |path: &Trajectory| sights::are_ordinary(&setting.nominal, path, &times_s);
        if self.world == World::Standard {
            return path(0);
        }
        (0..PATHS).map(path).find(sees_lines).unwrap_or_else(|| path(PATHS))
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let check = |name, value: f64, holds: bool, rule| {
            if holds { Ok(()) } else { Err(Error::Recipe { name, value, rule }) }
        };
        let frames = (1..=MOST_FRAMES).contains(&self.frames);
        check("frames", self.frames as f64, frames, "from 1 to 100000")?;
        for side in self.size {
            check("size", side.into(), (16..=MOST_PIXELS).contains(&side), "from 16 to 8192 pixels")?;
        }
        for effect in &self.effects {
            let (name, value, low, high, rule) = match *effect {
                Hidden::Defocus { sigma_px } => ("defocus", sigma_px, 0.0, 50.0, "from 0 to 50 pixels"),
                Hidden::MotionBlur { exposure_s } => {
                    ("motion_blur", exposure_s, 0.0, LONGEST_S, "from 0 to 0.5 seconds")
                }
                Hidden::RollingShutter { readout_s } => {
                    ("rolling_shutter", readout_s, -LONGEST_S, LONGEST_S, "within 0.5 seconds")
                }
                Hidden::TimeOffset { offset_s } => {
                    ("time_offset", offset_s, -LONGEST_S, LONGEST_S, "within 0.5 seconds")
                }
                Hidden::OdometryDelay { delay_s } => {
                    ("odometry_delay", delay_s, -LONGEST_S, LONGEST_S, "within 0.5 seconds")
                }
                Hidden::ImuDelay { delay_s } => {
                    ("imu_delay", delay_s, -LONGEST_S, LONGEST_S, "within 0.5 seconds")
                }
                Hidden::ClockJump { jump_s } => {
                    ("clock_jump", jump_s, -LONGEST_S, LONGEST_S, "within 0.5 seconds")
                }
                _ => continue,
            };
            check(name, value, (low..=high).contains(&value), rule)?;
        }
        Ok(())
    }
}
