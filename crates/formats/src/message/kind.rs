//! What a topic's messages are, by the fields that they have.

use crate::{
    log::Topic,
    schema::{Shape, View},
};

/// What messages are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MessageKind {
    /// Picture as pixels.
    Picture,
    /// Picture as JPEG or PNG.
    CompressedPicture,
    /// Calibration of a camera.
    Calibration,
    /// Pose by dead reckoning, with velocity.
    Odometry,
    /// Orientation and accelerations.
    Imu,
    /// Angles of joints.
    Joints,
    /// Transforms between frames.
    Transforms,
    /// One pose.
    Pose,
    /// Poses so far.
    Path,
    /// Description of the robot (URDF).
    Description,
}

impl MessageKind {
    /// Returns its name, as `info` prints it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::CompressedPicture => "compressed picture",
            Self::Calibration => "calibration",
            Self::Odometry => "odometry",
            Self::Imu => "imu",
            Self::Joints => "joints",
            Self::Transforms => "transforms",
            Self::Pose => "pose",
            Self::Path => "path",
            Self::Description => "robot description",
        }
    }

    /// Returns whether it is a picture of either kind.
    pub fn is_picture(self) -> bool {
        matches!(self, Self::Picture | Self::CompressedPicture)
    }
}

/// Fields, besides the message itself, in which another message may be wrapped: HULKs' time wrappers and pairs of pictures.
const WRAPPERS: [Option<&str>; 3] = [None, Some("inner"), Some("left")];

/// Foxglove's schemas, for JSON without a definition.
const NAMED: &[(&str, MessageKind)] = &[
    ("foxglove.CompressedImage", MessageKind::CompressedPicture),
    ("foxglove.RawImage", MessageKind::Picture),
    ("foxglove.CameraCalibration", MessageKind::Calibration),
    ("foxglove.FrameTransform", MessageKind::Transforms),
    ("foxglove.FrameTransforms", MessageKind::Transforms),
    ("foxglove.PoseInFrame", MessageKind::Pose),
];

/// What a topic's messages are, and where in them it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Role {
    /// What they are.
    pub kind: MessageKind,
    wrapper: Option<&'static str>,
}

impl Role {
    /// Tells what a topic's messages are; `None` if they are nothing that is read.
    pub fn of(topic: &Topic) -> Option<Self> {
        let shape = topic.definition.shape();
        if let Some(name) = shape.name_alone() {
            let kind = NAMED.iter().find(|(known, _)| *known == name)?.1;
            return Some(Self { kind, wrapper: None });
        }
        WRAPPERS.into_iter().find_map(|wrapper| {
            let kind = Fields { shape, wrapper }.kind(&topic.name)?;
            Some(Self { kind, wrapper })
        })
    }

    /// Opens a message of the topic.
    pub fn open<'a>(&self, topic: &'a Topic, data: &'a [u8]) -> Option<View<'a>> {
        let view = topic.definition.view(data)?;
        self.wrapper.map_or(Some(view), |wrapper| view.field(wrapper))
    }
}

/// Fields of a message, perhaps within another.
struct Fields<'a> {
    shape: Shape<'a>,
    wrapper: Option<&'static str>,
}

impl Fields<'_> {
    fn has(&self, path: &str) -> bool {
        match self.wrapper {
            Some(wrapper) => self.shape.has(&format!("{wrapper}.{path}")),
            None => self.shape.has(path),
        }
    }

    fn all(&self, paths: &[&str]) -> bool {
        paths.iter().all(|path| self.has(path))
    }

    fn kind(&self, topic: &str) -> Option<MessageKind> {
        let has = |path| self.has(path);
        let kind = if self.all(&["width", "height", "encoding", "data"]) {
            MessageKind::Picture
        } else if self.all(&["format", "data"]) && !has("width") {
            MessageKind::CompressedPicture
        } else if self.all(&["width", "height", "distortion_model"]) && (has("k") || has("K")) {
            MessageKind::Calibration
        } else if self.all(&["orientation.w", "angular_velocity.x", "linear_acceleration.x"]) {
            MessageKind::Imu
        } else if self.all(&["pose.pose.position.x", "twist"]) {
            MessageKind::Odometry
        } else if self.all(&["name", "position", "velocity"]) && !has("position.x") {
            MessageKind::Joints
        } else if has("poses.pose.position.x") {
            MessageKind::Path
        } else if has("pose.pose.position.x") || has("pose.position.x") {
            MessageKind::Pose
        } else if self.is_transform("transforms.") || self.is_transform("") {
            MessageKind::Transforms
        } else if has("data") && topic.ends_with("robot_description") {
            MessageKind::Description
        } else {
            return None;
        };
        Some(kind)
    }

    fn is_transform(&self, within: &str) -> bool {
        let has = |path: &str| self.has(&format!("{within}{path}"));
        has("child_frame_id") && (has("transform.rotation.w") || has("rotation.w"))
    }
}
