//! Pictures in the form that warps read: one 32-bit word per pixel.

use image::RgbImage;

/// Picture with one word per pixel: red in the lowest byte, then green and blue.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Pixels, row by row from the top.
    pub pixels: Vec<u32>,
}

impl Picture {
    /// Returns the number of bytes in memory.
    pub fn bytes(&self) -> usize {
        self.pixels.len() * size_of::<u32>()
    }

    /// Returns red, green and blue of the pixels, row by row from the top.
    pub fn colors(&self) -> impl Iterator<Item = [u8; 3]> {
        self.pixels.iter().map(|word| {
            let [red, green, blue, _] = word.to_le_bytes();
            [red, green, blue]
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
