//! Labels of a picture: classes, distances, lines, crossings and boxes. Elements are pictures.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use reality_sim::{
    CameraPose, Sequence,
    simulator::labels::{Labeler, Labels, Overlay},
    warp::{Hall, ProxyGeometry},
};

use crate::scene::Scene;

/// Measures the labels of the demonstration walk's pictures.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let walk = Sequence::open(&scene.walk.folder).expect("the demonstration walk is part of the repository");
    let poses: Vec<CameraPose> = walk.reference_poses().step_by(5).flatten().collect();
    let proxy = ProxyGeometry::new(&Hall::usual(&walk.field), &walk.field);
    let labeler = Labeler::new(&walk.setup.camera, &walk.field, &proxy);
    let mut labels = Labels::default();
    let mut turn = poses.iter().cycle().copied();
    let mut group = criterion.benchmark_group("labels");
    group.throughput(Throughput::Elements(1));
    group.bench_function("label", |bencher| {
        bencher.iter(|| {
            let pose = black_box(turn.next().unwrap_or_default());
            labeler.label(pose, &[], Overlay::default(), &mut labels);
            labels.classes.len()
        });
    });
    group.finish();
}
