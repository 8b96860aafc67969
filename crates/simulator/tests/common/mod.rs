//! Cameras over the demonstration walk.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, LazyLock},
};

use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::Sequence,
};
use reality_sim_db::{Database, PoseEstimate, PoseSource};
use reality_sim_simulator::Camera;
use reality_sim_synthesis::Archive;

/// Database of the demonstration walk, made once.
static WALK: LazyLock<(tempfile::TempDir, PathBuf)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.db");
    let walk = Sequence::open(Path::new("../../assets/walk")).unwrap();
    let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    Database::create_or_open(&file).unwrap().ingest(&walk, &poses, &PoseSource::GroundTruth).unwrap();
    (folder, file)
});

/// Returns a camera over the demonstration walk.
pub fn camera() -> Camera {
    Camera::new(Arc::new(Archive::open(&WALK.1, 64 << 20).unwrap()))
}

/// Returns a pose on the walk.
pub fn usual_pose(camera: &Camera) -> CameraPose {
    camera.synthesizer().archive().usual_pose().with_planar(Pose2::new(-2.3, 0.2, 1.2))
}
