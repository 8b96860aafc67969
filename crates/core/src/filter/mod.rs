//! Particle filter (Fig. 1 of the paper): initialize, predict, weigh and resample, with T iterations per picture.

mod estimate;
mod kld;
mod motion;
mod particle_filter;
mod resample;
mod rng;
mod scored;
mod weights;

pub use self::{
    estimate::{Estimator, spread_m, weighted_mean},
    kld::KldConfig,
    motion::{MotionNoise, PlanarSigma},
    particle_filter::{FilterConfig, FilterEstimate, ParticleFilter, alternatives, placed},
    resample::Resampling,
    rng::{Purpose, Stream},
    scored::{Filter, ScoredFilter},
    weights::{best_index, effective_sample_size, normalise},
};
