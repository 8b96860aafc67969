//! Search of images by pose: our index, which is exact, compared with a kd-tree that proposes candidates.

use std::{cell::LazyCell, hint::black_box, time::Duration};

use criterion::{BenchmarkId, Criterion, SamplingMode};
use reality_sim::db::index::PoseIndex;

use crate::{
    kd_tree::KdIndex,
    poses::{metric, random_poses},
    scene::Scene,
};

const IMAGES: [usize; 3] = [300, 10_000, 1_000_000];
/// Number of poses that are queried in turn.
const QUERIES: usize = 1000;
/// Numbers of candidates from the kd-tree.
const CANDIDATES: [usize; 2] = [16, 64];

/// Measures building the index, and one query.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let metric = metric(&scene.walk);
    let queries = random_poses(QUERIES, 1);
    for images in IMAGES {
        let poses = random_poses(images, 0);
        let mut group = criterion.benchmark_group(format!("neighbours/{images}"));
        group.sampling_mode(SamplingMode::Flat).measurement_time(Duration::from_secs(2));
        group.bench_function("build", |bencher| {
            bencher.iter(|| PoseIndex::new(metric.clone(), poses.clone()));
        });
        group.bench_function("build/kd_tree", |bencher| {
            bencher.iter(|| KdIndex::new(metric.clone(), poses.clone()));
        });
        // Made only when a requested benchmark needs it: a million poses take seconds.
        let index = LazyCell::new(|| PoseIndex::new(metric.clone(), poses.clone()));
        let mut turn = queries.iter().cycle().copied();
        let mut next = || turn.next().unwrap_or_default();
        for count in [1, 6] {
            group.bench_function(BenchmarkId::new("nearest", count), |bencher| {
                bencher.iter(|| index.nearest(black_box(next()), count));
            });
        }
        group.bench_function("natural", |bencher| bencher.iter(|| index.natural(black_box(next()))));
        let tree = LazyCell::new(|| KdIndex::new(metric.clone(), poses.clone()));
        let mut candidates = |count| {
            group.bench_function(BenchmarkId::new("kd_tree", count), |bencher| {
                bencher.iter(|| tree.nearest(black_box(next()), 1, count));
            });
        };
        CANDIDATES.into_iter().for_each(&mut candidates);
        group.finish();
    }
}
