//! Benchmarks, one file per stage. `README.md` explains how to read them.

mod blur;
mod border;
mod database;
mod frame;
mod gap;
#[cfg(feature = "gpu")]
mod gpu;
mod image_at;
mod import;
mod kd_tree;
mod labels;
mod neighbours;
mod poses;
mod refinement;
mod resampling;
mod scaling;
mod scene;
mod scoring;
mod search;
mod smoothing;
#[cfg(feature = "gpu")]
mod warp;
mod white_lines;

use std::time::Duration;

use criterion::Criterion;

use crate::scene::Scene;

fn main() {
    let scene = Scene::load();
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .without_plots()
        .configure_from_args();
    let stages: [fn(&mut Criterion, &Scene); 16] = [
        blur::bench,
        border::bench,
        white_lines::bench,
        scoring::bench,
        resampling::bench,
        frame::bench,
        refinement::bench,
        smoothing::bench,
        search::bench,
        scaling::bench,
        neighbours::bench,
        database::bench,
        image_at::bench,
        labels::bench,
        gap::bench,
        import::bench,
    ];
    for stage in stages {
        stage(&mut criterion, &scene);
    }
    #[cfg(feature = "gpu")]
    gpu::bench(&mut criterion, &scene);
    criterion.final_summary();
}
