//! A sequence as a robot's log.

use std::fs;

use glam::DQuat;
use reality_sim::{CameraPose, Sequence, sequence::FrameRecord};

use super::{
    cdr::{self, Value, encode, numbers},
    log_writer::{Kind, Messages},
};

fn header(time_s: f64, frame: &str) -> Value {
    let time_ns = (time_s * 1e9).round() as u64;
    let (seconds, nanos) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000);
    Value::All(vec![Value::I32(seconds as i32), Value::U32(nanos as u32), cdr::text(frame)])
}

fn rotation(turn: DQuat) -> Value {
    numbers(&[turn.x, turn.y, turn.z, turn.w])
}

/// Messages of a frame: picture, calibration, odometry and the camera's transform.
fn messages_of(walk: &Sequence, frame: &FrameRecord) -> [(&'static str, &'static str, Value); 4] {
    let time_s = frame.timestamp_s;
    let picture = fs::read(walk.folder.join(&frame.image)).unwrap();
    let picture = vec![header(time_s, "camera_optical_frame"), cdr::text("jpeg"), Value::Bytes(picture)];
    let (camera, odometry) = (&walk.setup.camera, frame.odometry.unwrap());
    let distortion = camera.distortion.parameters().into_iter().map(Value::F64).collect();
    let calibration = vec![
        header(time_s, "camera_optical_frame"),
        Value::U32(camera.height),
        Value::U32(camera.width),
        cdr::text("equidistant"),
        Value::Sequence(distortion),
        numbers(&[camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0]),
        numbers(&[0.0; 9]),
        numbers(&[0.0; 12]),
        Value::All([0; 6].map(Value::U32).to_vec()),
        Value::Byte(0),
    ];
    let dead_reckoning = vec![
        header(time_s, "odom"),
        cdr::text("base_link"),
        numbers(&[odometry.x_m, odometry.y_m, 0.0]),
        rotation(DQuat::from_rotation_z(odometry.yaw_rad)),
        numbers(&[0.0; 36 + 6 + 36]),
    ];
    // The rotation from the camera's own axes, by the library's definition of a pose.
    let mount = CameraPose { pitch_rad: frame.pitch_rad, roll_rad: frame.roll_rad, ..Default::default() };
    let transform = vec![
        header(time_s, "base_link"),
        cdr::text("camera_optical_frame"),
        numbers(&[0.0, 0.0, walk.setup.mount_height_m]),
        rotation(mount.quaternion_world_from_camera()),
    ];
    [
        ("/camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage", Value::All(picture)),
        ("/camera/camera_info", "sensor_msgs/msg/CameraInfo", Value::All(calibration)),
        ("/odom", "nav_msgs/msg/Odometry", Value::All(dead_reckoning)),
        ("/tf", "tf2_msgs/msg/TFMessage", Value::Sequence(vec![Value::All(transform)])),
    ]
}

/// Returns the messages of a sequence, as a robot would have logged them, a number of times one after the other.
pub fn walk_log(walk: &Sequence, times: usize) -> Messages {
    let later_s =
        2.0 * walk.frames.last().unwrap().timestamp_s - walk.frames[walk.frames.len() - 2].timestamp_s;
    let mut messages = Messages::default();
    for time in 0..times {
        for frame in &walk.frames {
            let timestamp_s = frame.timestamp_s + time as f64 * later_s;
            let frame = FrameRecord { timestamp_s, ..frame.clone() };
            for (topic, type_name, value) in messages_of(walk, &frame) {
                let log_time_ns = (timestamp_s * 1e9).round() as i64;
                messages.add(topic, &Kind::cdr(type_name, ""), log_time_ns, encode(&value, false));
            }
        }
    }
    messages
}
