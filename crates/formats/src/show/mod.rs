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

mod channels;
#[cfg(feature = "live")]
mod live;
mod log_file;
mod messages;

use reality_sim_core::{camera::Camera, field::FieldDimensions, pose::CameraPose};

#[cfg(feature = "live")]
pub use self::live::LiveView;
pub use self::log_file::{LogFile, remove_unfinished_logs};

/// Picture with everything that is shown of it.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// Time at which it was taken, seconds.
    pub timestamp_s: f64,
    /// JPEG or PNG file.
    pub picture: &'a [u8],
    /// Camera that took it.
    pub camera: &'a Camera,
    /// Field on which it was taken.
    pub field: &'a FieldDimensions,
    /// Pose of the camera.
    pub pose: CameraPose,
    /// Particles; none if they are not known.
    pub particles: &'a [CameraPose],
}
