//! Comparison of the shaders with their twins on the CPU. Needs an adapter; the package mesa-vulkan-drivers provides one
//! that runs on the processor.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use std::sync::Arc;

use reality_sim_gpu::{GpuContext, compare_filters, compare_scores, compare_warps};

fn context() -> Arc<GpuContext> {
    let context = GpuContext::new(None).unwrap();
    println!("on {:?}", context.adapter());
    Arc::new(context)
}

#[test]
fn the_shaders_score_as_their_twins_do() {
    let context = context();
    let comparisons = compare_scores(&context, 24).unwrap();
    comparisons.iter().for_each(|comparison| println!("{comparison:?}"));
    assert_eq!(comparisons.len(), 12, "three models, four cameras");
    assert!(comparisons.iter().all(reality_sim_gpu::ScoreComparison::agrees));
}

#[test]
fn an_iteration_of_the_filter_is_that_of_the_cpu() {
    let comparison = compare_filters(&context(), 24).unwrap();
    println!("{comparison:?}");
    assert!(comparison.updates == 24 && comparison.agrees(), "{comparison:?}");
}

/// Draws from every number of sources, with every lens, alone and mixed.
#[test]
fn pictures_are_drawn_as_on_the_cpu() {
    let context = context();
    let comparison = compare_warps(&context, 144).unwrap();
    println!("{comparison:?}");
    assert!(comparison.agrees(), "{comparison:?}");
}

#[test]
fn an_adapter_that_is_not_there_is_named_with_those_that_are() {
    let error = GpuContext::new(Some("no such card")).unwrap_err().to_string();
    assert!(error.contains("no such card") && error.contains("there is "), "{error}");
}
