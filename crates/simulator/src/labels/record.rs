//! Labels of one picture.

use glam::DVec2;
use image::{GrayImage, ImageBuffer, Luma};
use reality_sim_core::field::{Crossing, LineKind};

use crate::{class::Class, seen_object::SeenObject};

/// Labels of a picture. A label is what the centre of its pixel shows, and is exact for the field's dimensions, the pose and the
/// lens: neither blur nor light plays a part.
#[derive(Debug, Clone, Default)]
pub struct Labels {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Class of every pixel, row by row from the top.
    pub classes: Vec<Class>,
    /// Thing that every pixel shows: 0 for none, else its place in `things`, from 1.
    pub instances: Vec<u16>,
    /// Distance from the camera to what every pixel shows, along its ray, metres; infinite where the lens leaves it black. Beyond
    /// the field it is the distance to the box that stands for the hall.
    pub distance_m: Vec<f32>,
    /// Trust of every pixel, 0 to 255, see [`reality_sim_core::warp::Origin`]; 255 where an object was drawn.
    pub trust: Vec<u8>,
    /// White lines that are in view.
    pub lines: Vec<SeenLine>,
    /// All crossings and marks of the field, in the order of [`reality_sim_core::field::FieldDimensions::crossings`].
    pub crossings: Vec<SeenCrossing>,
    /// Goals at −x and at +x, then the objects, in the order in which they were given; also those out of view.
    pub things: Vec<SeenObject>,
}

/// Part of a white line in view.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenLine {
    /// Kind of the line.
    pub kind: LineKind,
    /// Number of the line in [`reality_sim_core::field::FieldDimensions::lines`].
    pub line: usize,
    /// Points of the line's centre, pixels, joined by straight lines: at least two.
    pub pixels: Vec<DVec2>,
}

/// Crossing or mark of the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenCrossing {
    /// Crossing of the field.
    pub crossing: Crossing,
    /// Pixel where it is; none if it is outside the picture.
    pub pixel: Option<DVec2>,
    /// Whether nothing stands before it.
    pub is_visible: bool,
}

impl Labels {
    /// Returns the numbers of the classes as a picture.
    pub fn class_picture(&self) -> GrayImage {
        self.picture(|index| self.classes[index].number())
    }

    /// Returns the trust as a picture.
    pub fn trust_picture(&self) -> GrayImage {
        self.picture(|index| self.trust[index])
    }

    /// Returns the distances as a picture, millimetres: 0 where the lens leaves the picture black, 65535 from there on.
    pub fn distance_picture(&self) -> ImageBuffer<Luma<u16>, Vec<u16>> {
        self.picture(|index| {
            let distance_m = self.distance_m[index];
            // A conversion to an integer keeps to its range.
            if distance_m.is_finite() { (1e3 * distance_m).round() as u16 } else { 0 }
        })
    }

    /// Returns the numbers of the things as a picture.
    pub fn instance_picture(&self) -> ImageBuffer<Luma<u16>, Vec<u16>> {
        self.picture(|index| self.instances[index])
    }

    fn picture<T: image::Primitive>(&self, value: impl Fn(usize) -> T) -> ImageBuffer<Luma<T>, Vec<T>>
    where
        Luma<T>: image::Pixel<Subpixel = T>,
    {
        let width = self.width as usize;
        ImageBuffer::from_fn(self.width, self.height, |u, v| Luma([value(v as usize * width + u as usize)]))
    }
}
