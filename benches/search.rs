//! Search of the whole field for the pose of a picture.

use criterion::{Criterion, SamplingMode};
use reality_sim::{mount::MountPoseSigma, search::GlobalSearch};

use crate::scene::Scene;

/// Measures the search; only the mount pose from joints and IMU is known.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let mount_sigma = MountPoseSigma::default();
    let mut search = GlobalSearch::new(&scene.walk.setup.camera, &scene.walk.field, mount_sigma);
    let mut group = criterion.benchmark_group("search");
    group.sampling_mode(SamplingMode::Flat);
    group.bench_function("whole_field", |bencher| {
        bencher.iter(|| search.search(scene.prepared(), scene.mount(), None, 0));
    });
    group.finish();
}
