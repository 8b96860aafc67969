//! A particle filter and the observation model that weighs its particles, as one.

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

/// One picture at a time: load it, predict, update. The particles may live on another device; what is asked of them
/// between updates may take a while to come from there. A device that fails is an error of the call that failed, and what
/// the filter holds is worth nothing until [`Filter::reset`].
pub trait Filter: Send + Sync {
    /// Takes over a new picture.
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError>;

    /// Hands over the picture that follows the one loaded: a device takes it while it computes.
    fn prefetch(&mut self, _next: &Arc<RgbImage>) {}

    /// Forgets all particles, and begins again as a new filter with this seed would.
    fn reset(&mut self, seed: u64);

    /// Places all particles anew, around several poses in proportion to their weights.
    fn initialize(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma) -> Result<(), BackendError>;

    /// Moves the particles to the next picture, see [`ParticleFilter::predict`].
    fn predict(&mut self, motion: Option<Motion2>) -> Result<(), BackendError>;

    /// Weighs and resamples T times, see [`ParticleFilter::update`].
    fn update(&mut self, mount: MountPose, sigma: PlanarSigma) -> Result<FilterEstimate, BackendError>;

    /// Turns all particles by 180° about the field's centre.
    fn mirror(&mut self) -> Result<(), BackendError>;

    /// The particles after the last iteration.
    fn particles(&self) -> Result<Vec<CameraPose>, BackendError>;

    /// Other places the picture may have been taken at, see [`ParticleFilter::alternatives`].
    fn alternatives(&self) -> &[CameraPose];
}

/// A [`ParticleFilter`] on this processor, weighed by any scorer.
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
    /// A filter without particles.
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
