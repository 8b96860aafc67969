//! Imports of logs that tests write, against the truth that went into them.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod cdr;
mod encodings;
mod faults;
mod foxglove;
mod foxglove_logs;
mod log_writer;
mod poses;
mod robot;

use std::fs;

use reality_sim_core::{field::FieldDimensions, sequence::Sequence};
use reality_sim_formats::{
    import::{ImportError, ImportOptions, ImportReport, import_log},
    log::Log,
};
use tempfile::TempDir;

use self::{
    cdr::{Value, encode},
    log_writer::{Kind, Messages},
    robot::{COMPRESSED, IMU, JOINTS, POSE, TF, Truth},
};

/// Sequence that was imported, with its folder, which lives as long.
struct Imported {
    sequence: Sequence,
    report: ImportReport,
    _folder: TempDir,
}

fn options() -> ImportOptions {
    ImportOptions {
        height_m: Some(robot::HEIGHT_M),
        ..ImportOptions::new("test", FieldDimensions::preset("spl").unwrap())
    }
}

/// Imports the bytes of an MCAP file.
fn import_bytes(bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.mcap");
    fs::write(&file, bytes).unwrap();
    import_file(folder, &file, options)
}

fn import_file(
    folder: TempDir,
    file: &std::path::Path,
    options: &ImportOptions,
) -> Result<Imported, ImportError> {
    let out = folder.path().join("sequence");
    let report = import_log(&Log::open(file)?, options, &out, &mut |_| {})?;
    Ok(Imported { sequence: Sequence::open(&out).unwrap(), report, _folder: folder })
}

/// Imports messages as an MCAP file with small chunks.
fn import(messages: &Messages, options: &ImportOptions) -> Result<Imported, ImportError> {
    import_bytes(&messages.mcap(Some(mcap::Compression::Lz4), Some(4096)), options)
}

/// Messages in ROS 2's encoding.
trait Ros {
    fn ros(
        &mut self,
        topic: &str,
        type_name: &'static str,
        definition: &str,
        log_time_ns: i64,
        value: &Value,
    );
}

impl Ros for Messages {
    fn ros(
        &mut self,
        topic: &str,
        type_name: &'static str,
        definition: &str,
        log_time_ns: i64,
        value: &Value,
    ) {
        self.add(topic, &Kind::cdr(type_name, definition), log_time_ns, encode(value, false));
    }
}

/// Pictures, calibration and odometry of a walk; pitch and roll are still to be told.
fn pictures(walk: &[Truth], camera: &str, child: &str) -> Messages {
    let mut messages = Messages::default();
    for (index, truth) in walk.iter().enumerate() {
        let (time, picture) = (truth.time_ns, robot::compressed(truth, camera, robot::jpeg(index)));
        messages.ros(
            "/camera/image/compressed",
            "sensor_msgs/msg/CompressedImage",
            COMPRESSED,
            time,
            &picture,
        );
        let info = robot::camera_info(truth, "plumb_bob", &[0.1, -0.02, 0.001, 0.0005, 0.0], robot::MATRIX);
        messages.ros("/camera/camera_info", "sensor_msgs/msg/CameraInfo", "", time, &info);
        messages.ros("/odom", "nav_msgs/msg/Odometry", "", time, &robot::odometry(truth, child));
    }
    messages
}

fn add_imu(messages: &mut Messages, truth: &Truth, value: &Value) {
    messages.ros("/imu", "sensor_msgs/msg/Imu", IMU, truth.time_ns, value);
}

fn add_tf(messages: &mut Messages, topic: &str, time_ns: i64, transforms: Vec<Value>) {
    messages.ros(topic, "tf2_msgs/msg/TFMessage", TF, time_ns, &Value::Sequence(transforms));
}

fn add_pose(messages: &mut Messages, time_ns: i64, value: &Value) {
    messages.ros("/mocap", "geometry_msgs/msg/PoseStamped", POSE, time_ns, value);
}

fn add_joints(messages: &mut Messages, time_ns: i64, value: &Value) {
    messages.ros("/joint_states", "sensor_msgs/msg/JointState", JOINTS, time_ns, value);
}

/// Pictures with an IMU on the camera.
fn with_imu(walk: &[Truth]) -> Messages {
    let mut messages = pictures(walk, "camera", "base_link");
    for truth in walk {
        let value = robot::imu(truth, "imu_link", Some(truth.level_from_body(1.0)), glam::DVec3::Z * 9.81);
        add_imu(&mut messages, truth, &value);
    }
    messages
}

/// Checks that all frames are there with their pitch, roll and odometry.
fn assert_like(imported: &Imported, walk: &[Truth]) {
    let frames = &imported.sequence.frames;
    assert_eq!(frames.len(), walk.len(), "{:?}", imported.report);
    for (frame, truth) in frames.iter().zip(walk) {
        assert!((frame.timestamp_s - truth.time_ns as f64 * 1e-9).abs() < 1e-9);
        assert!((frame.pitch_rad - truth.pitch_rad).abs() < 1e-9, "{frame:?} {truth:?}");
        assert!((frame.roll_rad - truth.roll_rad).abs() < 1e-9, "{frame:?} {truth:?}");
        let odometry = frame.odometry.unwrap();
        for (found, expected) in
            [(odometry.x_m, truth.x_m), (odometry.y_m, truth.y_m), (odometry.yaw_rad, truth.yaw_rad)]
        {
            assert!((found - expected).abs() < 1e-9, "{frame:?} {truth:?}");
        }
    }
}
