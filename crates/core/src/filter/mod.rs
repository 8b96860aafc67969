//! The particle filter (Fig. 1 of the paper): initialise, predict, weigh, resample, T iterations a frame.

mod resample;
mod rng;
mod weights;

pub use self::{
    resample::Resampling,
    rng::{Purpose, Stream},
    weights::{best_index, effective_sample_size, normalise},
};
