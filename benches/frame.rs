//! Whole frames: everything that `reality-sim tag` does with a picture once it is decoded.

use criterion::{BatchSize, Criterion, SamplingMode, Throughput};
use reality_sim::{Localizer, LocalizerConfig, ObservationKind};

use crate::scene::Scene;

/// Measures localization; elements are frames, processed one after the other as in a recording.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let walk = &scene.walk;
    let mut group = criterion.benchmark_group("frame");
    group.sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(walk.frames.len() as u64));
    for kind in ObservationKind::ALL {
        group.bench_function(kind.name(), |bencher| {
            bencher.iter_batched_ref(
                || {
                    let builder = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start);
                    builder.config(LocalizerConfig::new(kind)).build().expect("the processor never fails")
                },
                |localizer| {
                    let frames = scene.observations().map(|observation| localizer.update(&observation));
                    frames.last().expect("pictures").is_ok()
                },
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}
