//! A whole recording's poses at once.

use criterion::{Criterion, Throughput};
use reality_sim::{
    ObservationKind, TagConfig, Tagger,
    refine::{TrajectoryFrame, smooth_trajectory},
};

use crate::scene::Scene;

/// Frames of the recording: the pictures tagged, over and over.
const FRAMES: usize = 300;

/// Elements are frames.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let walk = &scene.walk;
    let config = TagConfig::new(ObservationKind::Contrast);
    let mut tagger = Tagger::new(&walk.setup.camera, &walk.field, walk.start, config);
    let tagged = scene.recorded().map(|picture| {
        let attitude = picture.attitude;
        (tagger.tag(&picture).expect("the processor never fails"), attitude)
    });
    let once: Vec<TrajectoryFrame> = tagged
        .map(|(frame, attitude)| TrajectoryFrame {
            guess: frame.pose,
            fit: frame.fit,
            attitude,
            motion: frame.motion,
        })
        .collect();
    let frames: Vec<TrajectoryFrame> = once.iter().cycle().take(FRAMES).copied().collect();
    let mut group = criterion.benchmark_group("smoothing");
    group.throughput(Throughput::Elements(FRAMES as u64));
    group.bench_function("trajectory", |bencher| {
        bencher.iter(|| smooth_trajectory(&frames, config.tolerance, config.filter.noise));
    });
    group.finish();
}
