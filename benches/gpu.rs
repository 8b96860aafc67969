//! The graphics device compared with the CPU: whole frames of the filter, many particles, search of the whole field, and
//! pictures drawn from others. The groups are named after the adapter; without an adapter there are none, and a line says
//! so.

#![expect(
    clippy::print_stdout,
    reason = "criterion prints there too: which device it was, and where its time went"
)]

use std::sync::Arc;

use criterion::{BatchSize, BenchmarkId, Criterion, SamplingMode, Throughput};
use reality_sim::{
    LocalizerConfig, ObservationKind,
    backend::{Backend, CpuBackend},
    filter::PlanarSigma,
    gpu::{GpuBackend, GpuContext, GpuFilter},
    mount::MountPoseSigma,
    observation::{CpuScorer, ObservationConfig},
    refine::{RefineConfig, Refiner},
    search::{GlobalSearch, SearchConfig, SearchGrid},
};

use crate::{scene::Scene, warp};

const SIGMA: PlanarSigma = PlanarSigma { position_m: 0.03, yaw_rad: 0.03 };
/// Numbers of particles scored at once by one iteration of the filter.
const PARTICLES: [usize; 4] = [800, 10_000, 100_000, 1_000_000];
/// Largest number of particles for a driver that runs on the processor.
const MOST_ON_PROCESSOR: usize = 100_000;
/// Grid of 0.1 m and 1° on the demonstration walk's carpet: at least the paper's 720,000 poses.
const GRID: SearchGrid = SearchGrid { step_m: 0.1, headings: 360 };

/// Measures on the CPU and on the best adapter. If there is no adapter, only a line that says so is printed.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    match GpuContext::new(None) {
        Ok(context) => bench_on(criterion, scene, &Arc::new(context)),
        Err(error) => println!("gpu: absent: {error}"),
    }
}

fn bench_on(criterion: &mut Criterion, scene: &Scene, context: &Arc<GpuContext>) {
    let adapter = context.adapter().clone();
    println!("gpu: {adapter:?}");
    let gpu = GpuBackend::new(context.clone());
    let backends: [(&str, &dyn Backend); 2] = [("cpu", &CpuBackend), (&adapter.name, &gpu)];
    whole_frames(criterion, scene, &backends);
    print_stages(scene, context);
    many_particles(criterion, scene, &backends, adapter.is_processor);
    search(criterion, scene, &backends);
    warp::bench(criterion, scene, &backends);
    start(criterion, scene, context, &adapter.name);
}

/// Measures a whole frame: upload, blur, five iterations of 800 particles, and read-back of the estimate. The border of
/// the field is excluded: the CPU finds it in both cases.
fn whole_frames(criterion: &mut Criterion, scene: &Scene, backends: &[(&str, &dyn Backend)]) {
    let walk = &scene.walk;
    for kind in ObservationKind::ALL {
        let mut group = criterion.benchmark_group(format!("filter/{kind}"));
        group.sampling_mode(SamplingMode::Flat);
        for (device, backend) in backends {
            let config = LocalizerConfig::new(kind);
            let mut filter = backend
                .filter(&walk.setup.camera, &walk.field, config.observation, config.filter)
                .expect("a device that works");
            filter.initialize(&[(scene.pose(), 1.0)], SIGMA).expect("a device that works");
            group.bench_function(*device, |bencher| {
                bencher.iter(|| {
                    filter.load(scene.prepared())?;
                    filter.predict(None)?;
                    filter.update(scene.mount(), SIGMA)
                });
            });
        }
        group.finish();
    }
}

/// Prints where a frame's time goes, by the device's own clock: every kernel in its own pass, averaged over several
/// frames.
fn print_stages(scene: &Scene, context: &Arc<GpuContext>) {
    use reality_sim::filter::Filter;

    const FRAMES: usize = 8;
    let walk = &scene.walk;
    for kind in ObservationKind::ALL {
        let config = LocalizerConfig::new(kind);
        let filter = GpuFilter::new(
            context.clone(),
            &walk.setup.camera,
            &walk.field,
            config.observation,
            config.filter,
        );
        let mut filter = filter.expect("a device that works");
        filter.initialize(&[(scene.pose(), 1.0)], SIGMA).expect("a device that works");
        let mut stages: Vec<(&str, f64)> = Vec::new();
        // The first frame is a warm-up.
        for frame in 0..=FRAMES {
            filter.load(scene.prepared()).expect("a device that works");
            filter.predict(None).expect("a device that works");
            let timed = match filter.timed_update(scene.mount(), SIGMA) {
                Ok(timed) => timed,
                Err(error) => return println!("filter/{kind}: stages: absent: {error}"),
            };
            for (stage, seconds) in timed.into_iter().filter(|_| frame > 0) {
                let milliseconds = 1e3 * seconds / FRAMES as f64;
                match stages.iter_mut().find(|(known, _)| *known == stage) {
                    Some((_, sum)) => *sum += milliseconds,
                    None => stages.push((stage, milliseconds)),
                }
            }
        }
        let total: f64 = stages.iter().map(|(_, milliseconds)| milliseconds).sum();
        let lines: Vec<String> =
            stages.iter().map(|(stage, milliseconds)| format!("{stage} {milliseconds:.3}")).collect();
        println!("filter/{kind}: stages, ms a frame: {}; together {total:.3}", lines.join(", "));
    }
}

/// Measures one iteration of `gauss`; elements are samples scored.
fn many_particles(
    criterion: &mut Criterion,
    scene: &Scene,
    backends: &[(&str, &dyn Backend)],
    is_processor: bool,
) {
    let walk = &scene.walk;
    let observation = ObservationConfig::new(ObservationKind::Gauss);
    let samples = CpuScorer::new(&walk.setup.camera, &walk.field, observation).samples();
    for particles in PARTICLES.into_iter().filter(|&count| !is_processor || count <= MOST_ON_PROCESSOR) {
        let mut group = criterion.benchmark_group(format!("one_iteration/{particles}"));
        group.sampling_mode(SamplingMode::Flat);
        group.throughput(Throughput::Elements((particles * samples) as u64));
        for (device, backend) in backends {
            let mut config = LocalizerConfig::new(ObservationKind::Gauss).filter;
            (config.particles, config.iterations) = (particles, 1);
            let mut filter = backend
                .filter(&walk.setup.camera, &walk.field, observation, config)
                .expect("a device that holds them");
            filter.load(scene.prepared()).expect("a device that works");
            filter.initialize(&[(scene.pose(), 1.0)], SIGMA).expect("a device that works");
            group.bench_function(*device, |bencher| bencher.iter(|| filter.update(scene.mount(), SIGMA)));
        }
        group.finish();
    }
}

/// Measures the search without any prior on the place; elements are poses. Half the carpet is searched: the other half is
/// its mirror image.
fn search(criterion: &mut Criterion, scene: &Scene, backends: &[(&str, &dyn Backend)]) {
    let walk = &scene.walk;
    let poses = GRID.places(&walk.field).len() / 2 * GRID.headings as usize;
    let mut group = criterion.benchmark_group("grid_search");
    group.sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(poses as u64));
    for (device, backend) in backends {
        let (camera, config) = (&walk.setup.camera, SearchConfig::default().with_grid(Some(GRID)));
        let refiner = Refiner::new(camera, &walk.field, RefineConfig::default(), MountPoseSigma::default());
        let search = GlobalSearch::with_backend(camera, &walk.field, config, refiner, *backend);
        let mut search = search.expect("a device that works");
        group.bench_function(BenchmarkId::new(*device, poses), |bencher| {
            bencher.iter(|| search.best_on_grid(scene.prepared(), scene.mount(), None));
        });
    }
    group.finish();
}

/// Measures opening a device, and making a filter with all its pipelines on an open device.
fn start(criterion: &mut Criterion, scene: &Scene, context: &Arc<GpuContext>, adapter: &str) {
    let walk = &scene.walk;
    let mut group = criterion.benchmark_group("start");
    group.sampling_mode(SamplingMode::Flat);
    group.bench_function(BenchmarkId::new("device", adapter), |bencher| {
        bencher.iter(|| GpuContext::new(None));
    });
    let config = LocalizerConfig::new(ObservationKind::Gauss);
    group.bench_function(BenchmarkId::new("pipelines", adapter), |bencher| {
        bencher.iter_batched(
            || context.clone(),
            |context| {
                GpuFilter::new(context, &walk.setup.camera, &walk.field, config.observation, config.filter)
            },
            BatchSize::PerIteration,
        );
    });
    group.finish();
}
