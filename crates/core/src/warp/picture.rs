//! Pictures in the form that warps read: one 32-bit word per pixel, with a mask in it.

use image::RgbImage;

/// Picture with one word per pixel: red in the lowest byte, then green, blue and the mask, which is [`Picture::SHOWN`] where
/// the pixel shows the scene. Warps leave out pixels with any other mask, and those interpolated from one.
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
    /// Mask of a pixel that shows the scene.
    pub const SHOWN: u8 = u8::MAX;

    /// Mask of a pixel that shows something in front of the scene.
    pub const HIDDEN: u8 = 0;

    /// Marks the pixels that show something in front of the scene.
    pub fn hide(&mut self, is_hidden: impl Fn(usize) -> bool) {
        for (_, word) in self.pixels.iter_mut().enumerate().filter(|(index, _)| is_hidden(*index)) {
            let [red, green, blue, _] = word.to_le_bytes();
            *word = u32::from_le_bytes([red, green, blue, Self::HIDDEN]);
        }
    }

    /// Returns whether the pixels show the scene, row by row from the top.
    pub fn shown(&self) -> impl Iterator<Item = bool> {
        self.pixels.iter().map(|word| word.to_le_bytes()[3] == Self::SHOWN)
    }

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
        let word =
            |pixel: &image::Rgb<u8>| u32::from_le_bytes([pixel.0[0], pixel.0[1], pixel.0[2], Self::SHOWN]);
        Self {
            width: picture.width(),
            height: picture.height(),
            pixels: picture.pixels().map(word).collect(),
        }
    }
}
