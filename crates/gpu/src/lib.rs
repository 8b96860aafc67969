//! Reality Sim's observation models, particle filter and picture warp on the GPU: the same results as
//! [`reality_sim_core::backend::CpuBackend`] gives, from compute shaders through wgpu. The shaders lie in the workspace's
//! `shaders/`, one entry point a file, named as their twins on the CPU.

mod backend;
mod buffers;
mod context;
mod error;
mod filter;
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

/// A device for tests: the best adapter there is. Without one a test fails and says what to install.
#[cfg(test)]
fn test_context() -> std::sync::Arc<GpuContext> {
    std::sync::Arc::new(GpuContext::new(None).unwrap_or_else(|error| panic!("{error}")))
}
