//! Pose of the camera, from each of its sources.

use glam::{DQuat, DVec3, EulerRot};

use super::{
    Ros, add_imu, add_joints, add_pose, add_tf, assert_like,
    cdr::{Value, text},
    import, options, pictures,
    robot::{self, HEIGHT_M, walk},
    with_imu,
};
use reality_sim_formats::import::ImportOptions;

/// Rotation of the camera's own axes in a body's: each axis by hand.
fn body_from_optical() -> DQuat {
    DQuat::from_mat3(&glam::DMat3::from_cols(-DVec3::Y, -DVec3::Z, DVec3::X))
}

#[test]
fn an_imu_in_body_axes_tells_pitch_and_roll() {
    let walk = walk(20);
    let imported = import(&with_imu(&walk), &options()).unwrap();
    assert_like(&imported, &walk);
    assert_eq!(imported.report.attitude_source, "imu");
    let setup = &imported.sequence.setup;
    assert_eq!(
        [setup.camera.fx, setup.camera.fy, setup.camera.cx, setup.camera.cy],
        [40.0, 41.0, 31.5, 23.5]
    );
    assert_eq!(setup.camera.distortion.parameters()[..4], [0.1, -0.02, 0.001, 0.0005]);
    let picture = std::fs::read(imported.sequence.image_path(7).unwrap()).unwrap();
    assert_eq!(picture, robot::jpeg(7));
}

#[test]
fn an_imu_in_optical_axes_tells_the_same() {
    let walk = walk(20);
    let mut messages = pictures(&walk, "camera_optical_frame", "base_link");
    for truth in &walk {
        let value = robot::imu(truth, "imu_optical_frame", Some(truth.level_from_optical(-2.0)), DVec3::ZERO);
        add_imu(&mut messages, truth, &value);
    }
    assert_like(&import(&messages, &options()).unwrap(), &walk);
}

#[test]
fn an_accelerometer_stands_in_for_a_missing_orientation() {
    let walk = walk(20);
    let mut messages = pictures(&walk, "camera", "base_link");
    for truth in &walk {
        let up = truth.level_from_body(0.7).inverse() * DVec3::Z;
        add_imu(&mut messages, truth, &robot::imu(truth, "imu", None, 9.7 * up));
    }
    let imported = import(&messages, &options()).unwrap();
    assert_like(&imported, &walk);
    assert_eq!(imported.report.attitude_source, "accelerometer");
    assert!(
        imported.report.notes.iter().any(|note| note.contains("no orientation")),
        "{:?}",
        imported.report
    );
}

#[test]
fn a_tf_tree_tells_height_pitch_roll_and_moves_the_odometry_to_the_camera() {
    let walk = walk(20);
    let mut messages = pictures(&walk, "camera_optical", "base_link");
    add_tf(
        &mut messages,
        "/tf_static",
        0,
        vec![robot::transform(0, "head", "camera_optical", DVec3::ZERO, body_from_optical())],
    );
    let ahead = DVec3::new(0.1, 0.02, 0.47);
    for truth in &walk {
        let turn = truth.level_from_body(0.0);
        add_tf(
            &mut messages,
            "/tf",
            truth.time_ns,
            vec![robot::transform(truth.time_ns, "base_link", "head", ahead, turn)],
        );
    }
    let imported = import(&messages, &ImportOptions { height_m: None, ..options() }).unwrap();
    assert_eq!(imported.report.attitude_source, "odometry+tf");
    assert!((imported.sequence.setup.mount_height_m - 0.47).abs() < 1e-12);
    for (frame, truth) in imported.sequence.frames.iter().zip(&walk) {
        assert!(
            (frame.pitch_rad - truth.pitch_rad).abs() < 1e-9
                && (frame.roll_rad - truth.roll_rad).abs() < 1e-9
        );
        let odometry = frame.odometry.unwrap();
        let (sin, cos) = truth.yaw_rad.sin_cos();
        assert!((odometry.x_m - (truth.x_m + cos * 0.1 - sin * 0.02)).abs() < 1e-9, "{odometry:?}");
        assert!((odometry.y_m - (truth.y_m + sin * 0.1 + cos * 0.02)).abs() < 1e-9, "{odometry:?}");
        assert!((odometry.yaw_rad - truth.yaw_rad).abs() < 1e-9);
    }
}

#[test]
fn an_imu_in_the_torso_is_moved_to_the_camera_by_tf() {
    let walk = walk(20);
    let mut messages = pictures(&walk, "camera", "base_footprint");
    let nod = DQuat::from_rotation_y(0.25) * DQuat::from_rotation_z(0.0);
    add_tf(&mut messages, "/tf_static", 0, vec![robot::transform(0, "torso", "camera", DVec3::Z * 0.1, nod)]);
    for truth in &walk {
        let torso = truth.level_from_body(0.3) * nod.inverse();
        add_imu(&mut messages, truth, &robot::imu(truth, "torso", Some(torso), DVec3::ZERO));
    }
    let imported = import(&messages, &options()).unwrap();
    assert_like(&imported, &walk);
    assert_eq!(imported.report.attitude_source, "imu+tf");
}

const URDF: &str = r#"<robot name="r">
  <joint name="neck_pitch" type="revolute"><parent link="base_link"/><child link="head"/>
    <origin xyz="0 0 0.45" rpy="0 0.1 0"/><axis xyz="0 1 0"/></joint>
  <joint name="eye" type="fixed"><parent link="head"/><child link="camera_optical"/>
    <origin xyz="0 0 0" rpy="-1.5707963267948966 0 -1.5707963267948966"/></joint>
</robot>"#;

#[test]
fn joints_tell_the_camera_s_pitch_through_the_robot_s_description() {
    let mut walk = walk(20);
    walk.iter_mut().for_each(|truth| truth.roll_rad = 0.0);
    let mut messages = pictures(&walk, "camera_optical", "base_link");
    messages.ros("/robot_description", "std_msgs/msg/String", "string data", 0, &text(URDF));
    for truth in &walk {
        let position = Value::Sequence(vec![Value::F64(truth.pitch_rad - 0.1)]);
        let names = Value::Sequence(vec![text("neck_pitch")]);
        let nothing = Value::Sequence(Vec::new());
        let value =
            Value::All(vec![robot::header(truth.time_ns, ""), names, position, nothing.clone(), nothing]);
        add_joints(&mut messages, truth.time_ns, &value);
    }
    let imported = import(&messages, &ImportOptions { height_m: None, ..options() }).unwrap();
    assert_like(&imported, &walk);
    assert_eq!(imported.report.attitude_source, "odometry+joints");
    assert!((imported.sequence.setup.mount_height_m - 0.45).abs() < 1e-12);
}

/// Reference poses at other times than the pictures, ten milliseconds apart.
fn reference_times() -> impl Iterator<Item = i64> {
    (0..200).map(|index| 1_000_000_000 + index * 10_000_000)
}

#[test]
fn a_reference_in_optical_or_body_axes_becomes_that_of_the_camera() {
    let walk = walk(20);
    for is_optical in [true, false] {
        let mut messages = with_imu(&walk);
        for time_ns in reference_times() {
            let at = robot::walk(20)[((time_ns - 1_000_000_000) / 100_000_000) as usize];
            let turn =
                if is_optical { at.level_from_optical(at.yaw_rad) } else { at.level_from_body(at.yaw_rad) };
            add_pose(
                &mut messages,
                time_ns,
                &robot::pose(time_ns, DVec3::new(at.x_m, at.y_m, HEIGHT_M), turn),
            );
        }
        let imported = import(&messages, &ImportOptions { height_m: None, ..options() }).unwrap();
        for (frame, truth) in imported.sequence.frames.iter().zip(&walk) {
            let pose = frame.reference_pose.unwrap();
            assert!(
                (pose.pitch_rad - truth.pitch_rad).abs() < 1e-9
                    && (pose.roll_rad - truth.roll_rad).abs() < 1e-9
            );
            assert!((pose.x_m - truth.x_m).abs() < 1e-9 && (pose.yaw_rad - truth.yaw_rad).abs() < 1e-9);
        }
        assert_eq!(imported.sequence.setup.mount_height_m, HEIGHT_M);
        assert_eq!(imported.sequence.poses_between_frames.len(), 180);
        let axes = if is_optical { "optical" } else { "body" };
        assert!(imported.report.notes.iter().any(|note| note.contains(axes)), "{:?}", imported.report.notes);
    }
}

#[test]
fn a_reference_of_the_base_is_moved_to_the_camera() {
    let walk = walk(20);
    let mut messages = pictures(&walk, "camera", "base_link");
    for truth in &walk {
        let nod = DQuat::from_euler(EulerRot::ZYX, 0.0, truth.pitch_rad, truth.roll_rad);
        add_tf(
            &mut messages,
            "/tf",
            truth.time_ns,
            vec![robot::transform(truth.time_ns, "base_link", "camera", DVec3::Z * HEIGHT_M, nod)],
        );
        let pose = robot::pose(
            truth.time_ns,
            DVec3::new(truth.x_m, truth.y_m, 0.0),
            DQuat::from_rotation_z(truth.yaw_rad),
        );
        add_pose(&mut messages, truth.time_ns, &pose);
    }
    let imported = import(&messages, &options()).unwrap();
    assert_like(&imported, &walk);
    for (frame, truth) in imported.sequence.frames.iter().zip(&walk) {
        let pose = frame.reference_pose.unwrap();
        assert!(
            (pose.height_m - HEIGHT_M).abs() < 1e-9 && (pose.pitch_rad - truth.pitch_rad).abs() < 1e-9,
            "{pose:?}"
        );
    }
}

#[test]
fn an_imu_in_an_unknown_frame_tilts_a_base_whose_camera_never_moves() {
    let walk = walk(20);
    let mut messages = pictures(&walk, "camera_optical", "base_link");
    let place = DVec3::Z * HEIGHT_M;
    let link = robot::transform(0, "base_link", "camera_optical", place, body_from_optical());
    add_tf(&mut messages, "/tf_static", 0, vec![link]);
    for truth in &walk {
        let value = robot::imu(truth, "imu_link", Some(truth.level_from_body(0.4)), DVec3::ZERO);
        add_imu(&mut messages, truth, &value);
    }
    let imported = import(&messages, &ImportOptions { height_m: None, ..options() }).unwrap();
    assert_like(&imported, &walk);
    assert!(imported.report.notes.iter().any(|note| note.contains("imu_link")), "{:?}", imported.report);
    assert_eq!(imported.sequence.setup.mount_height_m, HEIGHT_M);
}

#[test]
fn reference_poses_tell_pitch_and_roll_where_nothing_else_does() {
    let walk = walk(10);
    let mut messages = pictures(&walk, "camera", "base_link");
    for truth in &walk {
        let place = DVec3::new(truth.x_m, truth.y_m, HEIGHT_M);
        let pose = robot::pose(truth.time_ns, place, truth.level_from_optical(truth.yaw_rad));
        add_pose(&mut messages, truth.time_ns, &pose);
    }
    let imported = import(&messages, &options()).unwrap();
    assert_like(&imported, &walk);
    assert_eq!(imported.report.attitude_source, "reference");
}
