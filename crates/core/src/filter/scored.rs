//! A particle filter and the observation model that weighs its particles, as one.

use std::sync::Arc;

use image::RgbImage;

use super::{FilterConfig, FilterEstimate, ParticleFilter, PlanarSigma};
use crate::{
    observation::Scorer,
    pose::{CameraPose, Motion2, Pose2},
    preprocess::{Attitude, Prepared},
};

/// One picture at a time: load it, predict, update. The particles may live on another device; what is asked of them
/// between updates may take a while to come from there.
pub trait Filter: Send + Sync {
    /// Takes over a new picture.
    fn load(&mut self, picture: &Prepared);

    /// The picture that follows the one loaded: a device takes it over while it computes.
    fn announce(&mut self, _next: &Arc<RgbImage>) {}

    /// Places all particles anew, around several poses in proportion to their weights.
    fn place(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma);

    /// Carries the particles to the next picture, see [`ParticleFilter::predict`].
    fn predict(&mut self, motion: Option<Motion2>);

    /// Weighs and resamples T times, see [`ParticleFilter::update`].
    fn update(&mut self, attitude: Attitude, sigma: PlanarSigma) -> FilterEstimate;

    /// Turns all particles by 180° about the field's centre.
    fn mirror(&mut self);

    /// The particles after the last iteration.
    fn particles(&self) -> Vec<CameraPose>;

    /// Other places the picture may have been taken at, see [`ParticleFilter::rivals`].
    fn rivals(&self) -> Vec<CameraPose>;
}

/// A [`ParticleFilter`] on this processor, weighed by any scorer.
pub struct ScoredFilter {
    scorer: Box<dyn Scorer>,
    filter: ParticleFilter,
}

impl std::fmt::Debug for ScoredFilter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ScoredFilter").field("filter", &self.filter).finish_non_exhaustive()
    }
}

impl ScoredFilter {
    /// A filter without particles.
    pub fn new(scorer: Box<dyn Scorer>, config: FilterConfig) -> Self {
        Self { scorer, filter: ParticleFilter::empty(config) }
    }
}

impl Filter for ScoredFilter {
    fn load(&mut self, picture: &Prepared) {
        self.scorer.load(picture);
    }

    fn place(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma) {
        self.filter.place(modes, sigma);
    }

    fn predict(&mut self, motion: Option<Motion2>) {
        self.filter.predict(motion);
    }

    fn update(&mut self, attitude: Attitude, sigma: PlanarSigma) -> FilterEstimate {
        self.filter.update(&*self.scorer, attitude, sigma)
    }

    fn mirror(&mut self) {
        self.filter.mirror();
    }

    fn particles(&self) -> Vec<CameraPose> {
        self.filter.particles().to_vec()
    }

    fn rivals(&self) -> Vec<CameraPose> {
        self.filter.rivals().to_vec()
    }
}
