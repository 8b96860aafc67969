//! Resampling of 800 particles.

use criterion::{Criterion, Throughput};
use reality_sim::{
    ObservationKind,
    filter::{Purpose, Resampling, Stream, normalise},
    observation::{CpuScorer, ObservationConfig},
};

use crate::scene::Scene;

const PARTICLES: usize = 800;

/// Measures every scheme; elements are particles, weighted by a picture.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let config = ObservationConfig::new(ObservationKind::Gauss);
    let mut scorer = CpuScorer::new(&scene.walk.setup.camera, &scene.walk.field, config);
    scorer.set_picture(scene.prepared());
    let weights = normalise(&scorer.log_weights_of(&scene.particles(PARTICLES)));
    let stream = Stream::new(0, Purpose::Resample, 0, 0);
    let mut group = criterion.benchmark_group("resampling");
    group.throughput(Throughput::Elements(PARTICLES as u64));
    for scheme in Resampling::ALL {
        group.bench_function(scheme.name(), |bencher| {
            bencher.iter(|| scheme.resample(&weights, PARTICLES, stream));
        });
    }
    group.finish();
}
