//! A whole picture at a pose, as a simulator requests it: neighbours are found and chosen, brightness is matched, the
//! picture is drawn and filled. The neighbours' pictures are decoded beforehand. Elements are pictures.

use std::{cell::LazyCell, hint::black_box, sync::Arc};

use criterion::{Criterion, SamplingMode, Throughput};
use reality_sim::{
    Archive, CameraPose, Sequence, Synthesizer,
    db::{Database, PoseEstimate, PoseSource},
    synthesis::{Blend, Method, Nearest, Plane, Quadratic, SynthesisConfig},
    warp::CpuWarper,
};
use tempfile::TempDir;

use crate::scene::Scene;

/// Interval of the pictures that are not in the database; those in between are.
const LEFT_OUT: usize = 5;

/// Measures every method, with `blend` from four and from six pictures.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let walk = Sequence::open(&scene.walk.folder).expect("the demonstration walk is part of the repository");
    let poses: Vec<CameraPose> = walk.reference_poses().step_by(LEFT_OUT).flatten().collect();
    let stored = LazyCell::new(|| store(&walk));
    let methods: [(&str, &dyn Method, usize); 5] = [
        ("nearest", &Nearest, 1),
        ("quadratic", &Quadratic, 1),
        ("plane", &Plane, 1),
        ("blend4", &Blend, 4),
        ("blend6", &Blend, 6),
    ];
    let mut group = criterion.benchmark_group("image_at");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(1));
    for (name, method, sources) in methods {
        let synthesizer = LazyCell::new(|| {
            let archive = stored.1.clone();
            let config = SynthesisConfig::new(&archive).with_sources(sources);
            let camera = archive.setup().camera.clone();
            let synthesizer = Synthesizer::with(archive, camera, Arc::new(CpuWarper), config);
            poses.iter().for_each(|&pose| drop(synthesizer.image_at(pose, method)));
            synthesizer
        });
        let mut turn = poses.iter().cycle().copied();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let pose = black_box(turn.next().unwrap_or_default());
                synthesizer.image_at(pose, method).expect("a pose beside the walk")
            });
        });
    }
    group.finish();
}

/// Stores the walk without every fifth picture.
fn store(walk: &Sequence) -> (TempDir, Arc<Archive>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("walk.db");
    let estimate = |(frame, pose): (usize, Option<CameraPose>)| {
        let pose = pose.filter(|_| frame % LEFT_OUT != 0);
        pose.map(PoseEstimate::from)
    };
    let poses: Vec<_> = walk.reference_poses().enumerate().map(estimate).collect();
    let mut database = Database::create_or_open(&path).expect("a database");
    database.ingest(walk, &poses, &PoseSource::GroundTruth).expect("pictures of the walk");
    let archive = Archive::open(&path, 1 << 30).expect("a database");
    (folder, Arc::new(archive))
}
