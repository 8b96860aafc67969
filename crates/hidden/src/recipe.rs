//! Recipe of a recording: a seed, and the effects hidden in the recording.

use std::{fs, path::Path};

use glam::DVec2;
use rayon::prelude::*;
use reality_sim_core::sequence::Sequence;

use crate::{
    effect::Hidden,
    error::Error,
    exposure::Exposer,
    film::Film,
    jpeg, log,
    nominal::Nominal,
    random::Random,
    scene::Scene,
    trajectory::{Trajectory, Walk},
    truth::Truth,
};

/// Distance that the camera keeps inside the lines, metres.
const INSIDE_M: f64 = 0.5;
/// Largest number of frames of a recipe.
const MOST_FRAMES: usize = 100_000;
/// Largest width and height of a recipe's pictures, pixels.
const MOST_PIXELS: u32 = 8192;
/// Largest exposure time, readout time and clock offset, seconds.
const LONGEST_S: f64 = 0.5;

/// Recipe of a recording. Everything not given here is drawn from the seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// Seed of the hall, the camera, the walk and all noise. The same recipe gives the same bytes.
    pub seed: u64,
    /// Number of pictures, five per second.
    pub frames: usize,
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
    /// Effects that the files beside the pictures do not mention. Effects of one kind add up.
    pub effects: Vec<Hidden>,
    /// Motion of the robot.
    pub walk: Walk,
    /// Rate at which motion capture measures poses between the pictures, hertz; without it, only those at the pictures'
    /// times are in the files.
    pub capture_rate_hz: Option<f64>,
}

impl Recipe {
    /// Makes a recipe for 60 pictures of 640 × 480 pixels on a walk, with nothing hidden.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            frames: 60,
            size: [640, 480],
            effects: Vec::new(),
            walk: Walk::Walking,
            capture_rate_hz: None,
        }
    }

    /// Writes a complete sequence folder, creating it if it is missing, and returns its content: `sequence.toml`,
    /// `camera.toml`, `field.toml`, `frames.csv`, `groundtruth.tum` and the pictures.
    pub fn record(&self, folder: &Path) -> Result<Sequence, Error> {
        self.check()?;
        let nominal = Nominal::new(self.seed, self.size);
        let truth = Truth::new(&nominal, &self.effects);
        let trajectory = self.trajectory(&nominal);
        self.take_pictures(folder, &nominal, &truth, &trajectory)?;
        let mut frames = log::frames(self.seed, self.frames, self.walk, &trajectory, &truth);
        for (frame, pose) in frames.iter_mut().zip(log::references(self.seed, self.frames, &trajectory)) {
            frame.reference_pose = Some(pose);
        }
        let sequence = Sequence {
            folder: folder.to_path_buf(),
            files: Vec::new(),
            name: format!("hidden-{}", self.seed),
            setup: nominal.setup()?,
            frames,
            poses_between_frames: self.capture_rate_hz.map_or_else(Vec::new, |rate_hz| {
                log::references_between(self.seed, self.frames, rate_hz, &trajectory)
            }),
            start: Some(log::start(&trajectory)),
            field: nominal.field,
        };
        sequence.write(folder)?;
        Ok(Sequence::open(folder)?)
    }

    pub(crate) fn trajectory(&self, nominal: &Nominal) -> Trajectory {
        let inside = DVec2::new(nominal.field.length_m, nominal.field.width_m) / 2.0 - INSIDE_M;
        let duration_s = log::timestamp_s(self.frames);
        Trajectory::new(self.seed, self.walk, duration_s, inside, nominal.height_m)
    }

    fn take_pictures(
        &self,
        folder: &Path,
        nominal: &Nominal,
        truth: &Truth,
        trajectory: &Trajectory,
    ) -> Result<(), Error> {
        let images = folder.join("images");
        fs::create_dir_all(&images).map_err(|source| Error::Unwritable { path: images.clone(), source })?;
        let scene = Scene::new(self.seed, nominal, truth, trajectory);
        let exposer = Exposer::new(truth, self.size, nominal.light.psf_sigma_px);
        let span_s = [log::timestamp_s(0), log::timestamp_s(self.frames - 1)];
        let film = Film::new(truth, nominal.light, self.size, span_s);
        (0..self.frames).into_par_iter().try_for_each(|frame| {
            let time_s = log::timestamp_s(frame);
            let planes = exposer.expose(&scene, trajectory, time_s + truth.offset_s);
            let noise = &mut Random::stream(self.seed, "noise", frame as u64);
            let picture = film.develop(&planes, frame, time_s, noise);
            let path = images.join(format!("{frame:06}.jpg"));
            let bytes =
                jpeg::encode(&picture).map_err(|source| Error::Unencodable { path: path.clone(), source })?;
            fs::write(&path, bytes).map_err(|source| Error::Unwritable { path, source })
        })
    }

    fn check(&self) -> Result<(), Error> {
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
                _ => continue,
            };
            check(name, value, (low..=high).contains(&value), rule)?;
        }
        Ok(())
    }
}
