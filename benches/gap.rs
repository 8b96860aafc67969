//! The whole gap workflow, on small recordings of the tests' ray caster.

use criterion::{Criterion, Throughput};
use reality_sim::{
    Sequence,
    gap::{Options, Recording, ReferenceSource, analyse},
    sensor::Model,
};
use reality_sim_hidden::{Hidden, Recipe};
use tempfile::TempDir;

use crate::scene::Scene;

const FRAMES: usize = 40;
const SIZE: [u32; 2] = [320, 240];

/// Measures the workflow; elements are frames. Reading and decoding the pictures is part of it, and also measured alone.
pub fn bench(criterion: &mut Criterion, _: &Scene) {
    let mut group = criterion.benchmark_group("gap");
    group.throughput(Throughput::Elements(FRAMES as u64));
    let (_folder, plain) = recorded(Vec::new());
    group.bench_function("decoding", |bencher| bencher.iter(|| decode(&plain)));
    group.bench_function("nothing_hidden", |bencher| bencher.iter(|| whole(&plain)));
    let (_folder, pitched) = recorded(vec![Hidden::MountPitch { angle_rad: 0.02 }]);
    group.bench_function("one_effect_hidden", |bencher| bencher.iter(|| whole(&pitched)));
    group.finish();
}

fn recorded(effects: Vec<Hidden>) -> (TempDir, Sequence) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let recipe = Recipe { frames: FRAMES, size: SIZE, effects, ..Recipe::new(0) };
    let sequence = recipe.record(folder.path()).expect("a temporary folder can be written to");
    (folder, sequence)
}

fn decode(sequence: &Sequence) -> usize {
    let pictures = (0..FRAMES).map(|index| sequence.load_image(index).expect("a picture just written"));
    pictures.map(|picture| picture.len()).sum()
}

fn whole(sequence: &Sequence) -> usize {
    let recording = Recording::new(
        sequence,
        &sequence.reference_poses().collect::<Vec<_>>(),
        ReferenceSource::Measured,
        None,
    )
    .expect("a recording with poses");
    let analysis = analyse(&recording, &Model::default(), &Options::default(), &|_| ());
    analysis.expect("its pictures can be read").report.effects.len()
}
