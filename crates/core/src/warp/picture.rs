//! Pictures in the form in which warps read them: a word a pixel.

use image::RgbImage;

/// A picture, a word a pixel: red in the lowest byte, then green and blue.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row from the top.
    pub pixels: Vec<u32>,
}

impl Picture {
    /// Bytes that it takes in memory.
    pub fn bytes(&self) -> usize {
        self.pixels.len() * size_of::<u32>()
    }

    /// The same picture, three bytes a pixel.
    pub fn to_rgb(&self) -> RgbImage {
        RgbImage::from_fn(self.width, self.height, |u, v| {
            let [red, green, blue, _] = self.pixels[(v * self.width + u) as usize].to_le_bytes();
            image::Rgb([red, green, blue])
        })
    }
}

impl From<&RgbImage> for Picture {
    fn from(picture: &RgbImage) -> Self {
        let word = |pixel: &image::Rgb<u8>| u32::from_le_bytes([pixel.0[0], pixel.0[1], pixel.0[2], 0]);
        Self {
            width: picture.width(),
            height: picture.height(),
            pixels: picture.pixels().map(word).collect(),
        }
    }
}
