//! The topics of a simulator's camera.

use std::sync::{Arc, Mutex, PoisonError};

use byteorder::LittleEndian;
use cdr_encoding::to_writer;
use foxglove::{ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, Schema};
use serde::Serialize;

use super::{
    CameraShot, PixelLabels,
    depth::AxisShares,
    messages::{CameraInfo, Detection2DArray, Image, TfMessage, Time},
};
use crate::{schema::ros2_definition, show::Topics};

/// The four bytes before a message that name its encoding: plain CDR, little-endian.
const PLAIN_LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];

/// Room for everything of a message but its pixels, bytes.
const SMALL_BYTES: usize = 1 << 10;

/// Topics of a simulator's camera.
#[derive(Debug)]
pub struct CameraTopics {
    image: Arc<RawChannel>,
    camera_info: Arc<RawChannel>,
    depth: Arc<RawChannel>,
    classes: Arc<RawChannel>,
    instances: Arc<RawChannel>,
    objects: Arc<RawChannel>,
    transforms: Arc<RawChannel>,
    /// Those of the camera whose picture was the last.
    axis_shares: Mutex<Option<AxisShares>>,
}

impl Topics for CameraTopics {
    type Shot<'a> = CameraShot<'a>;

    const PROFILE: &'static str = "ros2";

    fn open(context: &Arc<Context>) -> Result<Self, FoxgloveError> {
        let channel = |topic: &str, type_name: &str| {
            let definition = ros2_definition(type_name).unwrap_or_default();
            let schema = Schema::new(type_name, "ros2msg", definition.into_bytes());
            ChannelBuilder::new(topic).context(context).message_encoding("cdr").schema(schema).build_raw()
        };
        Ok(Self {
            image: channel("/camera/image_raw", "sensor_msgs/msg/Image")?,
            camera_info: channel("/camera/camera_info", "sensor_msgs/msg/CameraInfo")?,
            depth: channel("/camera/depth", "sensor_msgs/msg/Image")?,
            classes: channel("/camera/classes", "sensor_msgs/msg/Image")?,
            instances: channel("/camera/instances", "sensor_msgs/msg/Image")?,
            objects: channel("/camera/objects", "vision_msgs/msg/Detection2DArray")?,
            transforms: channel("/tf", "tf2_msgs/msg/TFMessage")?,
            axis_shares: Mutex::new(None),
        })
    }

    fn timestamp_s(shot: &Self::Shot<'_>) -> f64 {
        shot.timestamp_s
    }

    fn log(&self, shot: &Self::Shot<'_>) {
        let time = Time::new(shot.timestamp_s);
        let image =
            |encoding, data: &[u8]| encoded(&Image::new(time, shot.camera, encoding, data), data.len());
        let send = |channel: &RawChannel, message: &dyn Fn() -> Vec<u8>| {
            // Nobody may have subscribed to a topic.
            if channel.has_sinks() {
                channel.log_with_meta(&message(), PartialMetadata::with_log_time(time.nanoseconds()));
            }
        };
        send(&self.transforms, &|| encoded(&TfMessage::new(time, shot.pose), 0));
        send(&self.camera_info, &|| encoded(&CameraInfo::new(time, shot.camera), 0));
        if let Some(PixelLabels { classes, instances, distance_m }) = shot.labels {
            send(&self.depth, &|| image("32FC1", &self.depths(shot, distance_m)));
            send(&self.classes, &|| image("mono8", classes));
            send(&self.instances, &|| {
                let bytes: Vec<u8> = instances.iter().flat_map(|number| number.to_le_bytes()).collect();
                image("mono16", &bytes)
            });
        }
        send(&self.objects, &|| encoded(&Detection2DArray::new(time, shot), 0));
        send(&self.image, &|| image("rgb8", shot.rgb));
    }
}

impl CameraTopics {
    fn depths(&self, shot: &CameraShot<'_>, distance_m: &[f32]) -> Vec<u8> {
        // What a panic leaves here is either whole or nothing.
        let mut kept = self.axis_shares.lock().unwrap_or_else(PoisonError::into_inner);
        let shares = kept.take().filter(|shares| shares.are_of(shot.camera));
        kept.insert(shares.unwrap_or_else(|| AxisShares::new(shot.camera))).depths(distance_m)
    }
}

/// Encodes a message with some bytes of pixels.
fn encoded<T: Serialize>(message: &T, pixel_bytes: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(pixel_bytes + SMALL_BYTES);
    bytes.extend(PLAIN_LITTLE_ENDIAN);
    // Only sequences of unknown length have no encoding, and writing into memory cannot fail.
    to_writer::<T, LittleEndian, _>(&mut bytes, message).expect("messages have an encoding");
    bytes
}
