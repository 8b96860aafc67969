//! Reality Sim's observation models, particle filter and picture warp on the GPU: the same results as
//! [`reality_sim_core::backend::CpuBackend`] gives, from compute shaders through wgpu.
//!
//! | type | purpose |
//! |---|---|
//! | [`adapters`], [`AdapterSummary`] | the graphics adapters of this machine, and what they can do |
//! | [`GpuContext`] | an open device |
//! | [`GpuBackend`] | an open device as a [`reality_sim_core::backend::Backend`] |
//! | [`GpuScorer`] | log-weights of poses, given a picture |
//! | [`GpuFilter`] | the particle filter, one submission per frame |
//! | [`GpuWarper`] | a picture drawn from others, read back or left on the device |
//! | [`compare_scores`], [`compare_filters`], [`compare_warps`] | whether a device computes the same as the CPU |
//! | [`GpuError`] | what is missing or has failed, and the remedy |
//!
//! The shaders are in `shaders/`, one entry point per file, named like their twins on the CPU. No window is needed. Units
//! and frames are those of [`reality_sim_core::pose`].
//!
//! ```
//! use std::sync::Arc;
//!
//! use reality_sim_core::backend::{Backend, CpuBackend};
//! use reality_sim_gpu::{GpuBackend, GpuContext};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // The best adapter there is; without any the CPU does the same.
//! let backend: Arc<dyn Backend> = match GpuContext::new(None) {
//!     Ok(context) => Arc::new(GpuBackend::new(Arc::new(context))),
//!     Err(error) => {
//!         eprintln!("{error}");
//!         Arc::new(CpuBackend)
//!     }
//! };
//! let warper = backend.warper()?;
//! # let _ = warper;
//! # Ok(())
//! # }
//! ```

mod backend;
mod buffers;
mod context;
mod error;
mod filter;
mod finishing;
mod kernel;
mod layers;
mod layout;
mod picture;
mod recent;
mod scorer;
mod scoring;
mod shader;
mod timing;
mod twins;
mod warp;
mod warp_twins;

// The crate whose types appear in public signatures.
pub use wgpu;

pub use self::{
    backend::GpuBackend,
    context::{AdapterSummary, GpuContext, adapters},
    error::GpuError,
    filter::GpuFilter,
    scorer::GpuScorer,
    twins::{
        EDGE_TOLERANCE, FilterComparison, SCORE_TOLERANCE, ScoreComparison, compare_filters, compare_scores,
    },
    warp::GpuWarper,
    warp_twins::{WARP_TOLERANCE, WarpComparison, compare_warps},
};

/// Opens the best adapter for tests. Without an adapter the test fails and says what to install.
#[cfg(test)]
fn test_context() -> std::sync::Arc<GpuContext> {
    std::sync::Arc::new(GpuContext::new(None).unwrap_or_else(|error| panic!("{error}")))
}
