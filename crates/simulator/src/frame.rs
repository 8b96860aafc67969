//! What a camera saw.

use image::RgbImage;
use reality_sim_core::{pose::CameraPose, warp::Origin};
use reality_sim_synthesis::UsedImage;

use crate::{class::Class, pixel_box::PixelBox};

/// Mark of a pixel in [`Frame::object_of`] that shows no object of a layer.
pub const NO_OBJECT: u16 = u16::MAX;

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
    /// Objects of all layers, in the order of the layers.
    pub objects: Vec<SeenObject>,
    /// What each pixel shows, row by row: a place in `objects`, or [`NO_OBJECT`]. A pixel half of which or more is covered by
    /// objects shows the one that covers most of it.
    pub object_of: Vec<u16>,
    /// Distance of the object that each pixel shows along the pixel's ray, metres; infinite where it shows none.
    pub distance_m: Vec<f32>,
}

/// Object of a layer as a camera saw it.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenObject {
    /// Class.
    pub class: Class,
    /// Name by which the simulator knows it.
    pub name: String,
    /// Box of the pixels that show it; `None` where none does.
    pub visible: Option<PixelBox>,
    /// Box of the pixels that would show it if nothing were in front of it.
    pub whole: Option<PixelBox>,
    /// Number of pixels that show it.
    pub visible_pixels: u32,
    /// Number of pixels that would show it if nothing were in front of it.
    pub whole_pixels: u32,
    /// Share of it that lies outside the picture, 0 to 1.
    pub truncation: f32,
}

impl SeenObject {
    /// Returns the share of the object's pixels in the picture that show it, 0 to 1; 0 where it is not in the picture.
    pub fn visibility(&self) -> f64 {
        f64::from(self.visible_pixels) / f64::from(self.whole_pixels.max(1))
    }
}
