//! One iteration of the filter with more particles and with more threads.

use criterion::{BatchSize, BenchmarkId, Criterion, SamplingMode, Throughput};
use rayon::ThreadPoolBuilder;
use reality_sim::{
    ObservationKind,
    filter::{FilterConfig, ParticleFilter, PlanarSigma},
    observation::{CpuScorer, ObservationConfig},
};

use crate::scene::Scene;

const PARTICLES: [usize; 4] = [100, 1_000, 10_000, 100_000];
const THREADS: [usize; 2] = [1, 2];

/// Measures diffusion, weighting by `gauss` and resampling; elements are particles.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let config = ObservationConfig::new(ObservationKind::Gauss);
    let mut scorer = CpuScorer::new(&scene.walk.setup.camera, &scene.walk.field, config);
    scorer.set_picture(scene.prepared());
    let sigma = PlanarSigma { position_m: 0.03, yaw_rad: 0.03 };
    for threads in THREADS {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut group = criterion.benchmark_group(format!("scaling/{threads}_threads"));
        group.sampling_mode(SamplingMode::Flat);
        for particles in PARTICLES {
            let config = FilterConfig::default().with_particles(particles).with_iterations(1);
            let filter = ParticleFilter::new(config, scene.pose(), sigma);
            group.throughput(Throughput::Elements(particles as u64));
            group.bench_function(BenchmarkId::from_parameter(particles), |bencher| {
                pool.install(|| {
                    bencher.iter_batched_ref(
                        || filter.clone(),
                        |filter| filter.update(&scorer, scene.mount(), sigma),
                        BatchSize::LargeInput,
                    );
                });
            });
        }
        group.finish();
    }
}
