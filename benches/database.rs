//! Ingestion of images into a database, and opening of a large database.

use std::{
    cell::LazyCell,
    path::{Path, PathBuf},
};

use criterion::{BatchSize, Criterion, SamplingMode, Throughput};
use reality_sim::db::{Database, PoseEstimate, PoseSource};
use reality_sim::synthesis::Archive;
use reality_sim::{CameraPose, Sequence};
use tempfile::TempDir;

use crate::{poses::random_poses, scene::Scene};

/// Number of times that the demonstration walk is added, each time as another recording.
const WALKS: usize = 10;
/// Number of images in the database that is opened.
const IMAGES: usize = 10_000;
/// Size of the cache for decoded pictures, bytes; nothing is decoded here.
const CACHE_BYTES: usize = 1 << 20;

/// Measures ingestion and opening; elements are images.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let walk = Sequence::open(&scene.walk.folder).expect("the demonstration walk is part of the repository");
    let mut group = criterion.benchmark_group("database");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements((WALKS * walk.frames.len()) as u64));
    let recordings: Vec<Sequence> = (0..WALKS).map(|number| renamed(&walk, number)).collect();
    group.bench_function("ingest", |bencher| {
        bencher.iter_batched(
            || tempfile::tempdir().expect("a temporary folder"),
            |folder| {
                let path = path_in(&folder);
                recordings.iter().for_each(|recording| ingest(&path, recording, &truth(recording)));
                folder
            },
            BatchSize::PerIteration,
        );
    });
    group.throughput(Throughput::Elements(IMAGES as u64));
    let large = LazyCell::new(|| large_database(&walk));
    group.bench_function("open", |bencher| {
        let path = path_in(&large);
        bencher.iter(|| Database::open(&path).and_then(|database| database.images()).expect("a database"));
    });
    group.bench_function("open/archive", |bencher| {
        let path = path_in(&large);
        bencher.iter(|| Archive::open(&path, CACHE_BYTES).expect("a database"));
    });
    group.finish();
}

/// Makes a database of the walk's pictures, repeated at other poses.
fn large_database(walk: &Sequence) -> TempDir {
    let mut recording = walk.clone();
    recording.frames = walk.frames.iter().cycle().take(IMAGES).cloned().collect();
    let poses: Vec<_> = random_poses(IMAGES, 0).into_iter().map(estimate).collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    ingest(&path_in(&folder), &recording, &poses);
    folder
}

fn path_in(folder: &TempDir) -> PathBuf {
    folder.path().join("walks.db")
}

fn ingest(path: &Path, recording: &Sequence, poses: &[Option<PoseEstimate>]) {
    let mut database = Database::create_or_open(path).expect("a database");
    let report = database.ingest(recording, poses, &PoseSource::GroundTruth).expect("pictures");
    assert_eq!(report.added, recording.frames.len(), "all of them are new");
}

fn renamed(walk: &Sequence, number: usize) -> Sequence {
    Sequence { name: format!("walk {number}"), ..walk.clone() }
}

fn truth(walk: &Sequence) -> Vec<Option<PoseEstimate>> {
    walk.reference_poses().map(|pose| pose.and_then(estimate)).collect()
}

fn estimate(pose: CameraPose) -> Option<PoseEstimate> {
    Some(PoseEstimate { pose, covariance: None })
}
