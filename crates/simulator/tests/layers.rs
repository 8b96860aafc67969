//! Layers through the whole camera, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    path::{Path, PathBuf},
    sync::{Arc, LazyLock},
};

use glam::{DVec2, Vec3};
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::Sequence,
};
use reality_sim_db::{Database, PoseEstimate, PoseSource};
use reality_sim_simulator::{Ball, Camera, Class, Frame, Humanoid, Layer, NO_OBJECT};
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

fn camera() -> Camera {
    Camera::new(Arc::new(Archive::open(&WALK.1, 64 << 20).unwrap()))
}

fn usual_pose(camera: &Camera) -> CameraPose {
    camera.synthesizer().archive().usual_pose().with_planar(Pose2::new(-2.3, 0.2, 1.2))
}

#[test]
fn a_picture_without_layers_is_the_recorded_one_and_layers_change_it_only_around_them() {
    let mut camera = camera();
    let pose = usual_pose(&camera);
    let (mut empty, mut full) = (Frame::default(), Frame::default());
    camera.look(pose, &[], &mut empty).unwrap();
    assert!(empty.object_of.iter().all(|object| *object == NO_OBJECT) && empty.objects.is_empty());
    let place = DVec2::new(-2.3, 0.2) + 1.2 * DVec2::from_angle(1.2);
    let ball = Ball::on_ground(place.x, place.y, 0.065, Vec3::new(0.9, 0.3, 0.05));
    let beside = place + DVec2::new(0.3, 0.3);
    let robot = Humanoid::standing(Pose2::new(beside.x, beside.y, -1.0), 0.58, Vec3::new(0.1, 0.2, 0.8));
    let layers: [&dyn Layer; 2] = [&ball, &robot];
    camera.look(pose, &layers, &mut full).unwrap();
    let [seen_ball, seen_robot] = full.objects.as_slice() else { panic!("{:?}", full.objects) };
    assert_eq!([seen_ball.class, seen_robot.class], [Class::Ball, Class::Robot]);
    assert!(seen_ball.visible_pixels > 100 && seen_ball.visibility() > 0.99, "{seen_ball:?}");
    assert!(seen_robot.visible_pixels > 500, "{seen_robot:?}");
    if let Ok(file) = std::env::var("LAYERS_PICTURE") {
        full.picture.save(file).unwrap();
    }
    let far = full.object_of.iter().zip(empty.picture.pixels().zip(full.picture.pixels()));
    let changed = far.filter(|(object, (a, b))| **object == NO_OBJECT && a != b).count();
    assert!(changed > 100 && changed < 60_000, "{changed}");
}
