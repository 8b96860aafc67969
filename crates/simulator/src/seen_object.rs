//! Things as a camera saw them.

use crate::{class::Class, pixel_box::PixelBox};

/// Mark of a pixel that shows no object of a layer.
pub const NO_OBJECT: u16 = u16::MAX;

/// Object of a layer, or goal, as a camera saw it.
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
