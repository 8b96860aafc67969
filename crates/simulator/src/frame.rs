//! What a camera saw.

use image::RgbImage;
use reality_sim_core::{pose::CameraPose, warp::Origin};
use reality_sim_synthesis::UsedImage;

use crate::{labels::Labels, seen_object::SeenObject};

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
    /// Share of the pixels that some recorded image shows, see [`reality_sim_synthesis::Reconstruction::covered`].
    pub covered: f64,
    /// Objects of all layers, in the order of the layers.
    pub objects: Vec<SeenObject>,
    /// What each pixel shows, row by row: a place in `objects`, or [`crate::NO_OBJECT`]. A pixel half of which or more is covered by
    /// objects shows the one that covers most of it.
    pub object_of: Vec<u16>,
    /// Distance of the object that each pixel shows along the pixel's ray, metres; infinite where it shows none.
    pub distance_m: Vec<f32>,
    /// Labels of the picture; empty unless the camera was asked for them.
    pub labels: Labels,
}
