//! What a camera saw.

use image::RgbImage;
use reality_sim_core::{pose::CameraPose, warp::Origin};
use reality_sim_synthesis::UsedImage;

use crate::labels::Labels;

/// Picture of a [`crate::Camera`] with what is known of its pixels. Used again and again, it keeps its memory.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Pose at which the picture was taken.
    pub pose: CameraPose,
    /// Picture.
    pub picture: RgbImage,
    /// Recorded images that the scene was made from.
    pub used: Vec<UsedImage>,
    /// Source in `used` and trust of every pixel of the scene, row by row.
    pub origins: Vec<Origin>,
    /// Labels of the picture; empty unless the camera was asked for them.
    pub labels: Labels,
}
