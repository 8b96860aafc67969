//! What Foxglove shows: pictures, calibration, poses, the field's lines in the picture and on the ground, particles; in an MCAP
//! file, or live through a websocket.
//!
//! | topic | schema | contents |
//! |---|---|---|
//! | `/camera/image` | `foxglove.CompressedImage` | the picture as it was recorded |
//! | `/camera/calibration` | `foxglove.CameraCalibration` | lens and picture size |
//! | `/camera/lines` | `foxglove.ImageAnnotations` | the field's lines at the pose, through the lens |
//! | `/camera/pose` | `foxglove.PoseInFrame` | the pose in the frame `world` |
//! | `/tf` | `foxglove.FrameTransform` | from `world` to `camera` |
//! | `/field` | `foxglove.SceneUpdate` | the field's lines on the ground |
//! | `/particles` | `foxglove.PosesInFrame` | the particles, where they are known |
//!
//! What a simulator's camera sees goes the same ways, with the topics of [`crate::ros2`].

mod foxglove_topics;
#[cfg(feature = "live")]
mod live;
mod log_file;
mod messages;
mod shot;
mod topics;

#[cfg(feature = "live")]
pub use self::{foxglove_topics::LiveView, live::TopicServer};
pub use self::{
    foxglove_topics::{FoxgloveTopics, LogFile},
    log_file::{TopicFile, remove_unfinished_logs},
    shot::Shot,
    topics::Topics,
};
