//! Evidence for white lines, and the distance of every pixel from it.

use criterion::{Criterion, Throughput};
use reality_sim::preprocess::distance_field;

use crate::scene::Scene;

/// Measures both; elements are pixels.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let picture = scene.prepared();
    let evidence = picture.evidence();
    let mut group = criterion.benchmark_group("white_lines");
    group.throughput(Throughput::Elements(evidence.len() as u64));
    group.bench_function("evidence", |bencher| bencher.iter(|| picture.evidence()));
    group.bench_function("distance_field", |bencher| bencher.iter(|| distance_field(&evidence)));
    group.finish();
}
