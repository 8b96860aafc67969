//! Gaussian blur of a picture.

use criterion::{BenchmarkId, Criterion, Throughput};
use reality_sim::preprocess::gaussian_blur;

use crate::scene::Scene;

/// Standard deviations of the blur: those of `contrast` and `gauss`, and one twice as wide, pixels.
const SIGMAS_PX: [f32; 3] = [0.7, 1.5, 3.0];

/// Measures the blur; elements are pixels.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let luma = &scene.prepared().luma();
    let mut group = criterion.benchmark_group("blur");
    group.throughput(Throughput::Elements(luma.len() as u64));
    for sigma_px in SIGMAS_PX {
        group.bench_with_input(BenchmarkId::from_parameter(sigma_px), &sigma_px, |bencher, &sigma_px| {
            bencher.iter(|| gaussian_blur(luma, sigma_px));
        });
    }
    group.finish();
}
