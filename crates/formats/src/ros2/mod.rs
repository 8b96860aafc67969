//! What a simulator's camera sees as messages of ROS 2, encoded in CDR with their definitions: an MCAP file that `ros2 bag play` plays, or
//! Foxglove's websocket, to which its bridges and panels connect: a [`TopicFile`](crate::show::TopicFile) or a
//! [`TopicServer`](crate::show) of [`CameraTopics`].
//!
//! | topic | type | contents |
//! |---|---|---|
//! | `/camera/image_raw` | `sensor_msgs/msg/Image`, `rgb8` | the picture |
//! | `/camera/camera_info` | `sensor_msgs/msg/CameraInfo` | the lens: `plumb_bob` or `equidistant` |
//! | `/camera/depth` | `sensor_msgs/msg/Image`, `32FC1` | metres along the optical axis (REP 118): infinite where nothing is, NaN 90° from the axis and beyond |
//! | `/camera/classes` | `sensor_msgs/msg/Image`, `mono8` | class of every pixel |
//! | `/camera/instances` | `sensor_msgs/msg/Image`, `mono16` | thing that every pixel shows |
//! | `/camera/objects` | `vision_msgs/msg/Detection2DArray` | boxes of the things that are seen, in pixels from the first pixel's corner |
//! | `/tf` | `tf2_msgs/msg/TFMessage` | from `world` to `camera_optical` |

mod depth;
mod messages;
mod topics;

use reality_sim_core::{camera::Camera, pose::CameraPose};

pub use self::topics::CameraTopics;

/// Picture of a simulator's camera, with what is known of it.
#[derive(Debug, Clone, Copy)]
pub struct CameraShot<'a> {
    /// Time at which it was taken, seconds.
    pub timestamp_s: f64,
    /// Camera that took it.
    pub camera: &'a Camera,
    /// Pose of the camera.
    pub pose: CameraPose,
    /// Red, green and blue of every pixel, row by row.
    pub rgb: &'a [u8],
    /// Labels of the pixels, if there are any.
    pub labels: Option<PixelLabels<'a>>,
    /// Things that are seen.
    pub objects: &'a [ObjectBox<'a>],
}

/// Labels of a picture, a value for every pixel, row by row.
#[derive(Debug, Clone, Copy)]
pub struct PixelLabels<'a> {
    /// Numbers of the classes.
    pub classes: &'a [u8],
    /// Numbers of the things; 0 is none.
    pub instances: &'a [u16],
    /// Distances along the pixels' rays, metres; infinite where nothing is.
    pub distance_m: &'a [f32],
}

/// Thing that a picture shows.
#[derive(Debug, Clone, Copy)]
pub struct ObjectBox<'a> {
    /// Name of its class.
    pub class: &'a str,
    /// Its number in [`PixelLabels::instances`].
    pub instance: u16,
    /// First column, first row, column after the last and row after the last of the pixels that show it.
    pub pixels: [u32; 4],
}
