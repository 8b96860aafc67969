//! Smoothing of a whole recording's poses.

use criterion::{Criterion, Throughput};
use reality_sim::{
    Localizer,
    refine::{TrajectoryFrame, smooth_trajectory},
};

use crate::scene::Scene;

/// Number of frames of the recording, which repeats the localized pictures.
const FRAMES: usize = 300;

/// Measures smoothing; elements are frames.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let walk = &scene.walk;
    let builder = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start);
    let mut localizer = builder.build().expect("the processor never fails");
    let config = *localizer.config();
    let once: Vec<TrajectoryFrame> = scene
        .observations()
        .map(|observation| localizer.update(&observation).expect("the processor never fails"))
        .map(|frame| TrajectoryFrame {
            guess: frame.pose,
            fit: frame.fit,
            mount: frame.mount,
            motion: frame.motion,
        })
        .collect();
    let frames: Vec<TrajectoryFrame> = once.iter().cycle().take(FRAMES).copied().collect();
    let mut group = criterion.benchmark_group("smoothing");
    group.throughput(Throughput::Elements(FRAMES as u64));
    group.bench_function("trajectory", |bencher| {
        bencher
            .iter(|| smooth_trajectory(&frames, &config.smoothing, config.mount_sigma, config.filter.noise));
    });
    group.finish();
}
