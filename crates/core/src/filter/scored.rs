//! A particle filter together with the observation model that weighs its particles.

use std::{fmt, sync::Arc};

use image::RgbImage;

use super::{FilterConfig, FilterEstimate, ParticleFilter, PlanarSigma};
use crate::{
    backend_error::BackendError,
    mount::MountPose,
    observation::Scorer,
    pose::{CameraPose, Motion2, Pose2},
    preprocess::Prepared,
};

/// Particle filter that handles one picture at a time: load it, predict, update. The particles may live on another
/// device, so that reading them between updates may be slow. If the device fails, the call returns an error, and the
/// state of the filter is invalid until [`Filter::reset`].
pub trait Filter: Send + Sync {
    /// Loads a new picture. Fails if the device does.
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError>;

    /// Hands over early the picture after the loaded one, so that a device can upload it while it computes.
    fn prefetch(&mut self, _next: &Arc<RgbImage>) {}

    /// Forgets all particles, and starts again as a new filter with this seed would.
    fn reset(&mut self, seed: u64);

    /// Replaces all particles by new ones around several poses, in proportion to the weights of the poses. Fails if the
    /// device does.
    fn initialize(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma) -> Result<(), BackendError>;

    /// Moves the particles to the next picture, see [`ParticleFilter::predict`]. Fails if the device does.
    fn predict(&mut self, motion: Option<Motion2>) -> Result<(), BackendError>;

    /// Weighs and resamples T times, see [`ParticleFilter::update`]. Fails if the device does.
    fn update(&mut self, mount: MountPose, sigma: PlanarSigma) -> Result<FilterEstimate, BackendError>;

    /// Turns all particles by 180° about the field's centre. Fails if the device does.
    fn mirror(&mut self) -> Result<(), BackendError>;

    /// Returns the particles after the last iteration. Fails if the device does.
    fn particles(&self) -> Result<Vec<CameraPose>, BackendError>;

    /// Returns other poses from which the picture may have been taken, see [`ParticleFilter::alternatives`].
    fn alternatives(&self) -> &[CameraPose];
}

/// [`ParticleFilter`] on the CPU, weighed by any scorer.
pub struct ScoredFilter {
    scorer: Box<dyn Scorer>,
    filter: ParticleFilter,
}

impl fmt::Debug for ScoredFilter {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("ScoredFilter").field("filter", &self.filter).finish_non_exhaustive()
    }
}

impl ScoredFilter {
    /// Returns a filter without particles.
    pub fn new(scorer: Box<dyn Scorer>, config: FilterConfig) -> Self {
        Self { scorer, filter: ParticleFilter::empty(config) }
    }
}

impl Filter for ScoredFilter {
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError> {
        self.scorer.load(picture)
    }

    fn reset(&mut self, seed: u64) {
        self.filter = ParticleFilter::empty(FilterConfig { seed, ..*self.filter.config() });
    }

    fn initialize(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma) -> Result<(), BackendError> {
        self.filter.initialize(modes, sigma);
        Ok(())
    }

    fn predict(&mut self, motion: Option<Motion2>) -> Result<(), BackendError> {
        self.filter.predict(motion);
        Ok(())
    }

    fn update(&mut self, mount: MountPose, sigma: PlanarSigma) -> Result<FilterEstimate, BackendError> {
        self.filter.update(&*self.scorer, mount, sigma)
    }

    fn mirror(&mut self) -> Result<(), BackendError> {
        self.filter.mirror();
        Ok(())
    }

    fn particles(&self) -> Result<Vec<CameraPose>, BackendError> {
        Ok(self.filter.particles().to_vec())
    }

    fn alternatives(&self) -> &[CameraPose] {
        self.filter.alternatives()
    }
}
