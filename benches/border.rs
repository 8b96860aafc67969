//! Detection of the field's border, carpet colour included.

use criterion::Criterion;
use reality_sim::preprocess::{BorderDetector, Preprocessor};

use crate::scene::Scene;

/// Measures the border alone, and the whole preprocessing that every model needs.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let detector = BorderDetector::new(&scene.walk.setup.camera);
    let preprocessor = Preprocessor::new(&scene.walk.setup.camera, scene.walk.field.line_width_m);
    let mut group = criterion.benchmark_group("border");
    group.bench_function("detect", |bencher| {
        bencher.iter(|| detector.detect(scene.picture(), scene.mount()));
    });
    group.bench_function("prepare", |bencher| {
        bencher.iter(|| preprocessor.prepare(scene.picture().clone(), scene.mount()));
    });
    group.finish();
}
