//! Projecting and weighting 800 particles, which takes most of a particle filter's time.

use criterion::{Criterion, Throughput};
use reality_sim::{
    ObservationKind,
    observation::{CpuScorer, ObservationConfig},
};

use crate::scene::Scene;

/// The paper's number of particles.
const PARTICLES: usize = 800;

/// Measures every model; elements are samples, those out of view included. Each sample of `contrast` is projected and
/// looked up three times.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let particles = scene.particles(PARTICLES);
    let mut group = criterion.benchmark_group("scoring");
    for kind in ObservationKind::ALL {
        let mut scorer =
            CpuScorer::new(&scene.walk.setup.camera, &scene.walk.field, ObservationConfig::new(kind));
        scorer.set_picture(scene.prepared());
        group.throughput(Throughput::Elements((PARTICLES * scorer.samples()) as u64));
        group.bench_function(kind.name(), |bencher| bencher.iter(|| scorer.log_weights_of(&particles)));
    }
    group.finish();
    let mut group = criterion.benchmark_group("load");
    for kind in ObservationKind::ALL {
        let mut scorer =
            CpuScorer::new(&scene.walk.setup.camera, &scene.walk.field, ObservationConfig::new(kind));
        group.bench_function(kind.name(), |bencher| bencher.iter(|| scorer.set_picture(scene.prepared())));
    }
    group.finish();
}
