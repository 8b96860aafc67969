//! The plugin in an application without a window, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{path::Path, sync::Arc};

use bevy::{
    asset::AssetPlugin,
    image::{Image, ImagePlugin},
    prelude::*,
};
use reality_sim::{
    Archive, CameraPose, Pose2, Sequence,
    db::{Database, PoseEstimate, PoseSource},
    image::RgbImage,
    pose::Motion2,
    simulator::Camera as LibraryCamera,
};
use reality_sim_bevy::{
    LookStatus, RealityBall, RealityCamera, RealityCameraPlugin, RealityRobot,
    axes::{bevy_from_world, camera_transform, ground_transform},
};
use tempfile::TempDir;

/// Makes a database of the first pictures of the walk, and a camera on it.
fn library_camera() -> (LibraryCamera, TempDir) {
    let mut walk = Sequence::open(Path::new("../../assets/walk")).unwrap();
    walk.frames.truncate(4);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.db");
    let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    Database::create_or_open(&file).unwrap().ingest(&walk, &poses, &PoseSource::GroundTruth).unwrap();
    (LibraryCamera::new(Arc::new(Archive::open(&file, 64 << 20).unwrap())), folder)
}

/// Application with the plugin; the camera's entity is on nothing yet.
struct Hall {
    app: App,
    camera: RealityCamera,
    pose: CameraPose,
    _folder: TempDir,
}

impl Hall {
    fn new() -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), ImagePlugin::default()))
            .add_plugins(RealityCameraPlugin);
        let (library, _folder) = library_camera();
        let pose = library.synthesizer().archive().images()[2].pose;
        let camera = RealityCamera::new(library, &mut app.world_mut().resource_mut::<Assets<Image>>());
        Self { app, camera, pose, _folder }
    }

    /// Returns a place before the camera.
    fn ahead(&self, forward_m: f64, left_m: f64) -> Pose2 {
        self.pose.planar().moved(Motion2 { forward_m, left_m, turn_rad: 0.0 })
    }
}

fn shown(app: &App, camera: Entity) -> Vec<u8> {
    let image = &app.world().get::<RealityCamera>(camera).unwrap().image;
    app.world().resource::<Assets<Image>>().get(image).unwrap().data.clone().unwrap()
}

fn rgba(picture: &RgbImage) -> Vec<u8> {
    picture.pixels().flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255]).collect()
}

#[test]
fn image_is_what_the_library_sees_from_the_place_of_the_entity() {
    let Hall { mut app, camera, pose, _folder } = Hall::new();
    let mut library = camera.camera.clone();
    let place = camera_transform(pose);
    let camera = app.world_mut().spawn((camera, place)).id();
    app.update();

    let mut expected = reality_sim::simulator::Frame::default();
    library.look(reality_sim_bevy::axes::camera_pose(&place.into()), &[], &mut expected).unwrap();
    assert!(expected.covered > 0.9);
    assert!(app.world().get::<RealityCamera>(camera).unwrap().status.is_seen());
    assert_eq!(shown(&app, camera), rgba(&expected.picture));
}

#[test]
fn balls_and_robots_are_seen_where_their_entities_are() {
    let hall = Hall::new();
    let [ball_at, robot_at] = [hall.ahead(1.0, 0.3), hall.ahead(1.5, -0.5)];
    let Hall { mut app, camera, pose, _folder } = hall;
    let lens = camera.camera.synthesizer().archive().setup().camera.clone();
    let camera = app.world_mut().spawn((camera, camera_transform(pose))).id();
    let center_in_world = ball_at.position_in_world().extend(0.065);
    let ball = RealityBall::new(0.065, Color::srgb_u8(225, 124, 48));
    app.world_mut().spawn((ball, Transform::from_translation(bevy_from_world(center_in_world))));
    let robot = RealityRobot::standing(0.58, Color::srgb_u8(48, 69, 188));
    app.world_mut().spawn((robot, ground_transform(robot_at), Name::new("goalkeeper")));
    app.update();

    let objects = &app.world().get::<RealityCamera>(camera).unwrap().frame.objects;
    let names: Vec<&str> = objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["ball", "goalkeeper"]);
    let expected = lens.project(pose.camera_from_world(center_in_world)).unwrap();
    let found = objects[0].visible.unwrap();
    let middle = [found.left + found.right, found.top + found.bottom].map(|sum| 0.5 * f64::from(sum));
    let is_near = (middle[0] - expected.x).abs() < 3.0 && (middle[1] - expected.y).abs() < 3.0;
    assert!(is_near, "{found:?} is not around {expected}");
    assert!(objects[1].visible_pixels > 500, "{:?}", objects[1]);
}

#[test]
fn camera_far_from_all_that_was_recorded_keeps_its_last_picture() {
    let Hall { mut app, camera, pose, _folder } = Hall::new();
    let camera = app.world_mut().spawn((camera, camera_transform(pose))).id();
    app.update();
    let before = shown(&app, camera);

    let away = pose.with_planar(Pose2::new(2.5, -1.5, -2.0));
    app.world_mut().entity_mut(camera).insert(camera_transform(away));
    app.update();
    let status = &app.world().get::<RealityCamera>(camera).unwrap().status;
    assert!(matches!(status, LookStatus::NotRecorded(_)), "{status:?}");
    assert!(shown(&app, camera) == before, "the picture stays");

    app.world_mut().entity_mut(camera).insert(camera_transform(pose));
    app.update();
    assert!(app.world().get::<RealityCamera>(camera).unwrap().status.is_seen());
}

#[test]
fn impossible_poses_are_errors_in_the_status_and_no_panic() {
    let Hall { mut app, camera, pose, _folder } = Hall::new();
    for transform in
        [camera_transform(CameraPose { height_m: -1.0, ..pose }), Transform::from_xyz(f32::NAN, 1.0, 0.0)]
    {
        let library = camera.camera.clone();
        let camera = RealityCamera::new(library, &mut app.world_mut().resource_mut::<Assets<Image>>());
        let camera = app.world_mut().spawn((camera, transform)).id();
        app.update();
        let status = &app.world().get::<RealityCamera>(camera).unwrap().status;
        assert!(status.error().is_some(), "{status:?}");
    }
}

#[test]
fn robot_is_not_seen_by_the_camera_that_it_carries() {
    let hall = Hall::new();
    let before_it = hall.ahead(1.2, 0.0);
    let Hall { mut app, camera, pose, _folder } = hall;
    let observer =
        RealityCamera::new(camera.camera.clone(), &mut app.world_mut().resource_mut::<Assets<Image>>());
    let carrier = ground_transform(pose.planar());
    let on_it = Transform::from_matrix(carrier.to_matrix().inverse() * camera_transform(pose).to_matrix());
    let robot = || RealityRobot::standing(0.58, Color::srgb_u8(48, 69, 188));
    app.world_mut().spawn((robot(), carrier, Name::new("carrier"))).with_child((camera, on_it));
    app.world_mut().spawn((robot(), ground_transform(before_it), Name::new("other")));
    app.world_mut().spawn((observer, camera_transform(pose)));
    app.update();

    let mut cameras = app.world_mut().query::<(&RealityCamera, Has<ChildOf>)>();
    for (camera, is_carried) in cameras.iter(app.world()) {
        let names: Vec<&str> = camera.frame.objects.iter().map(|object| object.name.as_str()).collect();
        assert!(camera.status.is_seen(), "{:?}", camera.status);
        assert_eq!(names.contains(&"carrier"), !is_carried, "{names:?}");
        assert!(names.contains(&"other"));
    }
}

#[test]
fn camera_that_is_not_active_does_not_look() {
    let Hall { mut app, camera, pose, _folder } = Hall::new();
    let camera = RealityCamera { is_active: false, ..camera };
    let camera = app.world_mut().spawn((camera, camera_transform(pose))).id();
    app.update();
    assert!(matches!(app.world().get::<RealityCamera>(camera).unwrap().status, LookStatus::Waiting));
    assert!(shown(&app, camera).chunks(4).all(|pixel| pixel == [0, 0, 0, 255]));
}
