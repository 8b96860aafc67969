//! A picture beside a walk's path, drawn from one and from four of the walk's pictures. Elements are pixels.

use std::sync::Arc;

use criterion::{Criterion, SamplingMode, Throughput};
use reality_sim::{
    CameraPose, Pose2,
    backend::Backend,
    camera::KernelCamera,
    warp::{BlendWeights, Hall, Picture, Placement, ProxyGeometry, RayTable, Source, Target},
};

use crate::scene::Scene;

/// Names, and the numbers of pictures drawn from.
const METHODS: [(&str, usize); 2] = [("plane", 1), ("blend4", 4)];

/// Measures every backend in turn. The source pictures stay the same, as they do while a viewer moves about.
pub fn bench(criterion: &mut Criterion, scene: &Scene, backends: &[(&str, &dyn Backend)]) {
    let walk = &scene.walk;
    let camera = KernelCamera::new(&walk.setup.camera);
    let rays = RayTable::new(&walk.setup.camera);
    let Pose2 { x_m, y_m, yaw_rad } = scene.pose();
    let pose = scene.mount().at(Pose2::new(x_m + 0.1, y_m - 0.05, yaw_rad + 0.1));
    let proxy = ProxyGeometry::new(&Hall::usual(&walk.field), &walk.field).holding(pose);
    let target = Target { rays: &rays, placement: Placement::new(pose), proxy: &proxy };
    for (name, count) in METHODS {
        let views: Vec<(CameraPose, Arc<Picture>)> =
            scene.neighbours(count).map(|(pose, picture)| (pose, Arc::new(Picture::from(picture)))).collect();
        let source = |(pose, picture)| Source {
            camera: &camera,
            placement: Placement::new(pose),
            picture,
            gain: [1.0; 3],
        };
        let sources: Vec<Source> = views.iter().map(|(pose, picture)| source((*pose, picture))).collect();
        let mut group = criterion.benchmark_group(format!("warp/{name}"));
        group.sampling_mode(SamplingMode::Flat);
        group.throughput(Throughput::Elements(u64::from(rays.width * rays.height)));
        for (device, backend) in backends {
            let warper = backend.warper().expect("a device that works");
            let weights = BlendWeights::default();
            group.bench_function(*device, |bencher| {
                bencher.iter(|| warper.blend(&target, &sources, &weights).expect("a device that works"));
            });
        }
        group.finish();
    }
}
