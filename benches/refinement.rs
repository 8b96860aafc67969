//! Fit of one picture's pose to a fraction of a pixel.

use criterion::Criterion;
use reality_sim::{
    mount::MountPoseSigma,
    preprocess::Texture,
    refine::{Reach, RefineConfig, Refiner},
};

use crate::scene::Scene;

/// Measures the fit from a start 3 cm away from the true place.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let refiner = Refiner::new(
        &scene.walk.setup.camera,
        &scene.walk.field,
        RefineConfig::default(),
        MountPoseSigma::default(),
    );
    let texture = Texture::pack(&scene.prepared().whiteness);
    let contrast = f64::from(scene.prepared().levels.contrast());
    let mut guess = scene.mount().at(scene.pose());
    guess.x_m += 0.03;
    criterion.bench_function("refinement", |bencher| {
        bencher.iter(|| refiner.fit(&texture, guess, scene.mount(), contrast, Reach::Wide));
    });
}
