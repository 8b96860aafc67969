//! Messages as serde's structures: their fields in the order of the definitions in `schema/builtin.rs`.

use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    pose::CameraPose,
};
use serde::{Serialize, Serializer};

use super::{CameraShot, ObjectBox};

/// Frame of the field.
const WORLD: &str = "world";

/// Frame of the camera, with the optical axes of REP 103.
const CAMERA: &str = "camera_optical";

/// `builtin_interfaces/msg/Time`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Time {
    sec: i32,
    nanosec: u32,
}

/// `std_msgs/msg/Header`.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Header {
    stamp: Time,
    frame_id: &'static str,
}

/// `uint8[]`, written at once.
#[derive(Debug)]
pub struct Bytes<'a>(pub &'a [u8]);

/// `sensor_msgs/msg/Image`.
#[derive(Debug, Serialize)]
pub struct Image<'a> {
    header: Header,
    height: u32,
    width: u32,
    encoding: &'static str,
    is_bigendian: u8,
    step: u32,
    data: Bytes<'a>,
}

/// `sensor_msgs/msg/RegionOfInterest`.
#[derive(Debug, Default, Serialize)]
struct RegionOfInterest {
    x_offset: u32,
    y_offset: u32,
    height: u32,
    width: u32,
    do_rectify: bool,
}

/// `sensor_msgs/msg/CameraInfo`.
#[derive(Debug, Serialize)]
pub struct CameraInfo {
    header: Header,
    height: u32,
    width: u32,
    distortion_model: &'static str,
    d: Vec<f64>,
    k: [f64; 9],
    r: [f64; 9],
    p: [f64; 12],
    binning_x: u32,
    binning_y: u32,
    roi: RegionOfInterest,
}

/// `geometry_msgs/msg/Transform`: place, then quaternion.
#[derive(Debug, Serialize)]
struct Transform {
    translation: [f64; 3],
    rotation: [f64; 4],
}

/// `geometry_msgs/msg/TransformStamped`.
#[derive(Debug, Serialize)]
struct TransformStamped {
    header: Header,
    child_frame_id: &'static str,
    transform: Transform,
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Debug, Serialize)]
pub struct TfMessage {
    transforms: Vec<TransformStamped>,
}

/// `vision_msgs/msg/ObjectHypothesisWithPose`; the pose is not known.
#[derive(Debug, Serialize)]
struct ObjectHypothesisWithPose<'a> {
    class_id: &'a str,
    score: f64,
    position: [f64; 3],
    orientation: [f64; 4],
    covariance: [[f64; 6]; 6],
}

/// `vision_msgs/msg/BoundingBox2D`.
#[derive(Debug, Serialize)]
struct BoundingBox2D {
    center: [f64; 2],
    theta: f64,
    size_x: f64,
    size_y: f64,
}

/// `vision_msgs/msg/Detection2D`.
#[derive(Debug, Serialize)]
struct Detection2D<'a> {
    header: Header,
    results: Vec<ObjectHypothesisWithPose<'a>>,
    bbox: BoundingBox2D,
    id: String,
}

/// `vision_msgs/msg/Detection2DArray`.
#[derive(Debug, Serialize)]
pub struct Detection2DArray<'a> {
    header: Header,
    detections: Vec<Detection2D<'a>>,
}

impl Serialize for Bytes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(self.0)
    }
}

impl Time {
    /// Converts seconds; times before 0 and after 2038 are the nearest that a message can have.
    pub fn new(timestamp_s: f64) -> Self {
        let nanoseconds = (timestamp_s * 1e9).round().clamp(0.0, 1e9 * f64::from(i32::MAX)) as u64;
        Self { sec: (nanoseconds / 1_000_000_000) as i32, nanosec: (nanoseconds % 1_000_000_000) as u32 }
    }

    /// Returns nanoseconds since 1970.
    pub fn nanoseconds(self) -> u64 {
        1_000_000_000 * self.sec as u64 + u64::from(self.nanosec)
    }

    /// Returns the header of a message about the camera.
    pub fn of_camera(self) -> Header {
        Header { stamp: self, frame_id: CAMERA }
    }
}

impl<'a> Image<'a> {
    /// Makes an image of a camera's size; its pixels are little-endian.
    pub fn new(time: Time, camera: &Camera, encoding: &'static str, data: &'a [u8]) -> Self {
        let Camera { width, height, .. } = *camera;
        Self {
            header: time.of_camera(),
            height,
            width,
            encoding,
            is_bigendian: 0,
            step: data.len() as u32 / height.max(1),
            data: Bytes(data),
        }
    }
}

impl CameraInfo {
    /// Describes a camera.
    pub fn new(time: Time, camera: &Camera) -> Self {
        let Camera { fx, fy, cx, cy, width, height, .. } = *camera;
        let (distortion_model, d) = match camera.distortion {
            Distortion::Pinhole => ("plumb_bob", vec![0.0; 5]),
            Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }) => ("plumb_bob", vec![k1, k2, p1, p2, k3]),
            Distortion::OpencvFisheye(OpencvFisheye { k }) => ("equidistant", k.to_vec()),
        };
        Self {
            header: time.of_camera(),
            height,
            width,
            distortion_model,
            d,
            k: [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            p: [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
            binning_x: 0,
            binning_y: 0,
            roi: RegionOfInterest::default(),
        }
    }
}

impl TfMessage {
    /// Places the camera in the world.
    pub fn new(time: Time, pose: CameraPose) -> Self {
        let transform = Transform {
            translation: pose.position_in_world().to_array(),
            rotation: pose.quaternion_world_from_camera().normalize().to_array(),
        };
        let header = Header { stamp: time, frame_id: WORLD };
        Self { transforms: vec![TransformStamped { header, child_frame_id: CAMERA, transform }] }
    }
}

impl<'a> Detection2DArray<'a> {
    /// Lists the things that a picture shows.
    pub fn new(time: Time, shot: &CameraShot<'a>) -> Self {
        let detections = shot.objects.iter().map(|object| Detection2D::new(time, object)).collect();
        Self { header: time.of_camera(), detections }
    }
}

impl<'a> Detection2D<'a> {
    fn new(time: Time, object: &ObjectBox<'a>) -> Self {
        let [left, top, right, bottom] = object.pixels.map(f64::from);
        let hypothesis = ObjectHypothesisWithPose {
            class_id: object.class,
            // It is known.
            score: 1.0,
            position: [0.0; 3],
            orientation: [0.0, 0.0, 0.0, 1.0],
            covariance: [[0.0; 6]; 6],
        };
        let bbox = BoundingBox2D {
            center: [(left + right) / 2.0, (top + bottom) / 2.0],
            theta: 0.0,
            size_x: right - left,
            size_y: bottom - top,
        };
        Self { header: time.of_camera(), results: vec![hypothesis], bbox, id: object.instance.to_string() }
    }
}
