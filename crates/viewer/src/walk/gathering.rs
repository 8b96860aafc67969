//! Beginning of the demonstration, as in Fig. 1 of the paper: particles spread over the whole field gather where the first
//! picture fits.
//!
//! It is the particle filter itself, on the device of the settings, with one iteration at a time on a picture that stays; it
//! does not know where the recording starts. Two things differ, so that one can watch it. Log-weights are divided by a
//! constant, or all particles but a few would die in the first iteration. And `contrast` gives way to the paper's Eq. 1: it
//! tells places apart only within a line's width, and particles spread over a field are farther apart than that.

use std::{f64::consts::TAU, sync::Arc};

use glam::DVec2;
use image::RgbImage;
use reality_sim_core::{
    backend::{Backend, BackendError},
    filter::{Filter, FilterEstimate, PlanarSigma},
    localization::{LocalizerConfig, Observation},
    mount::MountPose,
    observation::{CpuScorer, ObservationConfig, ObservationKind},
    pose::{CameraPose, Pose2},
    preprocess::Preprocessor,
    sequence::Sequence,
};

use super::{
    frame::{Found, GatheringStep, Record, Seen},
    settings::FilterSettings,
};

/// Number of updates.
const UPDATES: u32 = 12;
/// Time for which the spread particles are shown, seconds.
const SPREAD_S: f64 = 0.8;
/// Time for which each later step is shown, seconds.
const STEP_S: f64 = 0.2;
/// Least number of particles: with 3000, all gather at the mirror pose for two of four seeds.
const MIN_PARTICLES: usize = 5000;
/// Divisor of log-weights. With 25, particles gather in about ten updates on the demonstration; with 8, in three.
const SOFTENING: f64 = 25.0;
/// Diffusion before each update, less than a line's basin.
const SIGMA: PlanarSigma = PlanarSigma { position_m: 0.05, yaw_rad: 0.06 };
/// Largest distance between the poses around which the particles are spread, metres, and their number of headings.
const SPREAD_STEP_M: f64 = 0.5;
const SPREAD_HEADINGS: u32 = 8;

/// Particles on their way to the place of the first picture.
pub struct Gathering {
    filter: Box<dyn Filter>,
    mount: MountPose,
    truth: Option<CameraPose>,
    /// The filter's observation model, which weighs the particles that are shown.
    pub scorer: CpuScorer,
    pub seen: Seen,
    updates: u32,
}

impl Gathering {
    /// Spreads the particles over the field of a recording, whose first picture is given. Fails if the device does.
    pub fn new(
        sequence: &Sequence,
        picture: &Arc<RgbImage>,
        preprocessor: &mut Preprocessor,
        settings: &FilterSettings,
        backend: &dyn Backend,
    ) -> Result<Self, BackendError> {
        let Sequence { setup, field, .. } = sequence;
        let LocalizerConfig { observation, filter: config, .. } = config(settings);
        let mount = Observation::of_frame(sequence, 0, picture).mount;
        let truth = sequence.frames[0].reference_pose;
        let prepared = preprocessor.prepare(picture.clone(), mount);
        let mut filter = backend.filter(&setup.camera, field, observation, config)?;
        filter.load(&prepared)?;
        let half_extent_m = field.carpet_half_extent_m();
        let (places, sigma) = spread(half_extent_m);
        filter.initialize(&places, sigma)?;
        let scorer = CpuScorer::new(&setup.camera, field, observation);
        let particles: Vec<CameraPose> =
            filter.particles()?.iter().map(|particle| mount.at(particle.planar())).collect();
        let estimate = estimate_of_spread(mount, half_extent_m, particles.len());
        let found = found(&estimate, particles, 0, truth);
        let seen = Seen::new(prepared, mount, found);
        Ok(Self { filter, mount, truth, scorer, seen, updates: 0 })
    }

    /// Diffuses, weighs and resamples the particles once. Fails if the device does.
    pub fn advance(&mut self) -> Result<(), BackendError> {
        self.filter.predict(None)?;
        let estimate = self.filter.update(self.mount, SIGMA)?;
        let particles = self.filter.particles()?;
        self.updates += 1;
        self.seen.found = found(&estimate, particles, self.updates, self.truth);
        Ok(())
    }

    /// Whether all updates are done.
    pub fn is_over(&self) -> bool {
        self.updates == UPDATES
    }

    /// Returns for how long the present step is shown, seconds.
    pub fn pause_s(&self) -> f64 {
        if self.updates == 0 { SPREAD_S } else { STEP_S }
    }
}

/// Returns the localizer's settings with those of the gathering.
fn config(settings: &FilterSettings) -> LocalizerConfig {
    let mut config = settings.config();
    if config.observation.kind == ObservationKind::Contrast {
        config.observation = ObservationConfig::new(ObservationKind::Distance);
    }
    config.observation.alpha *= SOFTENING;
    // Weights are of the planar poses alone, as in the paper.
    config.filter.mount_sigma = None;
    let filter = &mut config.filter;
    filter.particles = filter.particles.max(MIN_PARTICLES);
    filter.iterations = 1;
    // Before each update, the filter predicts a motion that nothing has measured.
    (filter.noise.unknown_m, filter.noise.unknown_rad) = (SIGMA.position_m, SIGMA.yaw_rad);
    config
}

/// Returns poses all over the carpet, each with its weight, and the spread of particles around them with which these cover
/// it evenly.
fn spread(half_extent_m: DVec2) -> (Vec<(Pose2, f64)>, PlanarSigma) {
    let counts = (2.0 * half_extent_m / SPREAD_STEP_M).ceil();
    let step_m = 2.0 * half_extent_m / counts;
    let places = (0..counts.x as u32).flat_map(|x| (0..counts.y as u32).map(move |y| (x, y)));
    let poses = places.flat_map(|(x, y)| {
        let place = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * step_m - half_extent_m;
        let yaw_rad = |heading: u32| TAU * f64::from(heading) / f64::from(SPREAD_HEADINGS);
        (0..SPREAD_HEADINGS).map(move |heading| (Pose2::new(place.x, place.y, yaw_rad(heading)), 1.0))
    });
    let sigma = PlanarSigma {
        position_m: 0.5 * step_m.max_element(),
        yaw_rad: 0.5 * TAU / f64::from(SPREAD_HEADINGS),
    };
    (poses.collect(), sigma)
}

/// Returns the estimate before the first update, which tells nothing yet: all particles weigh the same.
fn estimate_of_spread(mount: MountPose, half_extent_m: DVec2, particles: usize) -> FilterEstimate {
    FilterEstimate {
        pose: mount.at(Pose2::default()),
        log_weight: f64::NEG_INFINITY,
        effective_sample_size: particles as f64,
        spread_m: half_extent_m.length() / 3_f64.sqrt(),
        particles,
    }
}

fn found(
    estimate: &FilterEstimate,
    particles: Vec<CameraPose>,
    number: u32,
    truth: Option<CameraPose>,
) -> Found {
    let best_particle = estimate.pose;
    Found {
        record: Record::of_filter(0, best_particle, estimate, truth),
        best_particle,
        particles,
        gathering: Some(GatheringStep { number, of: UPDATES }),
    }
}
