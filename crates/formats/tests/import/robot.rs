//! A robot with a camera, whose messages tests write: a walk along x with a nodding head.

use std::io::Cursor;

use glam::{DMat3, DQuat, DVec3};
use image::{ImageFormat, Rgb, RgbImage};

use super::cdr::{Value, numbers, text};

pub const SIZE: [u32; 2] = [64, 48];
pub const HEIGHT_M: f64 = 0.5;

/// Definitions as ROS 2 writes them; dependencies are those that are built in.
pub const IMAGE: &str = "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data";
pub const COMPRESSED: &str = "std_msgs/Header header\nstring format\nuint8[] data";
pub const IMU: &str = "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance";
pub const TF: &str = "geometry_msgs/TransformStamped[] transforms";
pub const POSE: &str = "std_msgs/Header header\ngeometry_msgs/Pose pose";
pub const JOINTS: &str =
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort";

/// What is true at a time.
#[derive(Debug, Clone, Copy)]
pub struct Truth {
    pub time_ns: i64,
    pub x_m: f64,
    pub y_m: f64,
    pub yaw_rad: f64,
    pub pitch_rad: f64,
    pub roll_rad: f64,
}

/// Returns the truth at `count` times, ten a second.
pub fn walk(count: usize) -> Vec<Truth> {
    let truth = |index: usize| {
        let t = index as f64 * 0.1;
        Truth {
            time_ns: 1_000_000_000 + index as i64 * 100_000_000,
            x_m: 0.2 * t,
            y_m: 0.05 * t,
            yaw_rad: 0.3 * t,
            pitch_rad: 0.4 + 0.1 * (2.0 * t).sin(),
            roll_rad: 0.05 * (3.0 * t).cos(),
        }
    };
    (0..count).map(truth).collect()
}

impl Truth {
    /// Rotation from body axes, by turns about z, y and x, each as its matrix.
    pub fn level_from_body(&self, yaw_rad: f64) -> DQuat {
        let rotation = DMat3::from_rotation_z(yaw_rad)
            * DMat3::from_rotation_y(self.pitch_rad)
            * DMat3::from_rotation_x(self.roll_rad);
        DQuat::from_mat3(&rotation)
    }

    /// Rotation from the camera's own axes: columns right, down, forward.
    pub fn level_from_optical(&self, yaw_rad: f64) -> DQuat {
        let body = DMat3::from_quat(self.level_from_body(yaw_rad));
        DQuat::from_mat3(&DMat3::from_cols(-body.y_axis, -body.z_axis, body.x_axis))
    }
}

pub fn header(time_ns: i64, frame: &str) -> Value {
    let (seconds, nanos) = (time_ns.div_euclid(1_000_000_000), time_ns.rem_euclid(1_000_000_000));
    Value::All(vec![Value::I32(seconds as i32), Value::U32(nanos as u32), text(frame)])
}

pub fn rotation(rotation: DQuat) -> Value {
    numbers(&[rotation.x, rotation.y, rotation.z, rotation.w])
}

/// JPEG of a grey that depends on a number, so that no two are the same.
pub fn jpeg(index: usize) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let shade = |x: u32, y: u32| Rgb([(x * 4) as u8, (y * 5) as u8, (index * 7) as u8]);
    RgbImage::from_fn(SIZE[0], SIZE[1], shade).write_to(&mut bytes, ImageFormat::Jpeg).unwrap();
    bytes.into_inner()
}

pub fn compressed(truth: &Truth, frame: &str, file: Vec<u8>) -> Value {
    Value::All(vec![header(truth.time_ns, frame), text("jpeg"), Value::Bytes(file)])
}

pub fn raw(truth: &Truth, frame: &str, encoding: &str, step: u32, data: Vec<u8>) -> Value {
    Value::All(vec![
        header(truth.time_ns, frame),
        Value::U32(SIZE[1]),
        Value::U32(SIZE[0]),
        text(encoding),
        Value::Byte(0),
        Value::U32(step),
        Value::Bytes(data),
    ])
}

pub fn camera_info(truth: &Truth, model: &str, d: &[f64], k: [f64; 9]) -> Value {
    let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    Value::All(vec![
        header(truth.time_ns, "camera"),
        Value::U32(SIZE[1]),
        Value::U32(SIZE[0]),
        text(model),
        Value::Sequence(d.iter().copied().map(Value::F64).collect()),
        numbers(&k),
        numbers(&identity),
        numbers(&[0.0; 12]),
        Value::U32(0),
        Value::U32(0),
        Value::All([0; 4].map(Value::U32).to_vec()),
        Value::Byte(0),
    ])
}

pub const MATRIX: [f64; 9] = [40.0, 0.0, 31.5, 0.0, 41.0, 23.5, 0.0, 0.0, 1.0];

pub fn odometry(truth: &Truth, child: &str) -> Value {
    let turned = DQuat::from_rotation_z(truth.yaw_rad);
    Value::All(vec![
        header(truth.time_ns, "odom"),
        text(child),
        numbers(&[truth.x_m, truth.y_m, 0.0]),
        rotation(turned),
        numbers(&[0.0; 36]),
        numbers(&[0.0; 6]),
        numbers(&[0.0; 36]),
    ])
}

pub fn imu(truth: &Truth, frame: &str, orientation: Option<DQuat>, acceleration: DVec3) -> Value {
    let covariance = if orientation.is_some() { 0.0 } else { -1.0 };
    Value::All(vec![
        header(truth.time_ns, frame),
        rotation(orientation.unwrap_or(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0))),
        numbers(&[covariance, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        numbers(&[0.0; 3]),
        numbers(&[0.0; 9]),
        numbers(&acceleration.to_array()),
        numbers(&[0.0; 9]),
    ])
}

pub fn transform(time_ns: i64, parent: &str, child: &str, place: DVec3, turn: DQuat) -> Value {
    Value::All(vec![header(time_ns, parent), text(child), numbers(&place.to_array()), rotation(turn)])
}

pub fn pose(time_ns: i64, place: DVec3, turn: DQuat) -> Value {
    Value::All(vec![header(time_ns, "world"), numbers(&place.to_array()), rotation(turn)])
}
