//! Pictures as cameras deliver them: RGB or grey, owned, shared or borrowed.

use std::{fmt, sync::Arc};

use image::{GrayImage, Rgb, RgbImage};

/// Camera picture with 8 bits per channel. Clones share its pixels.
///
/// An owned or shared RGB picture is taken over without a copy; a borrowed one is copied once. A grey picture becomes RGB
/// with three equal channels. Its lines are found as in a colour picture, but without green there is no carpet border, so
/// nothing beyond it is masked, and without goal colours the halves of the field cannot be told apart.
#[derive(Clone)]
pub struct Picture {
    pixels: Arc<RgbImage>,
    is_grey: bool,
}

/// The buffer does not have the number of bytes that a picture of this size needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a picture of {} x {} pixels has {expected} bytes, and the buffer has {found}: give one row after the other, without padding",
    size[0], size[1]
)]
pub struct InvalidPicture {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Number of bytes that a picture of this size has.
    pub expected: usize,
    /// Number of bytes in the buffer.
    pub found: usize,
}

impl Picture {
    /// Copies RGB pixels from a buffer, row by row without padding. `size` is width and height, pixels. Fails if the
    /// number of bytes does not match.
    pub fn from_rgb(size: [u32; 2], bytes: &[u8]) -> Result<Self, InvalidPicture> {
        let expected = byte_count(size, 3);
        let invalid = InvalidPicture { size, expected, found: bytes.len() };
        if bytes.len() != expected {
            return Err(invalid);
        }
        RgbImage::from_raw(size[0], size[1], bytes.to_vec()).map(Self::from).ok_or(invalid)
    }

    /// Copies grey pixels from a buffer, row by row without padding. `size` is width and height, pixels. Fails if the
    /// number of bytes does not match.
    pub fn from_grey(size: [u32; 2], bytes: &[u8]) -> Result<Self, InvalidPicture> {
        let expected = byte_count(size, 1);
        let invalid = InvalidPicture { size, expected, found: bytes.len() };
        if bytes.len() != expected {
            return Err(invalid);
        }
        let rgb = bytes.iter().flat_map(|&value| [value; 3]).collect();
        let pixels = RgbImage::from_raw(size[0], size[1], rgb).ok_or(invalid)?;
        Ok(Self { pixels: Arc::new(pixels), is_grey: true })
    }

    /// Returns the RGB pixels; the three channels of a grey picture are equal.
    pub fn pixels(&self) -> &Arc<RgbImage> {
        &self.pixels
    }

    /// Returns width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.pixels.dimensions().into()
    }

    /// Returns whether the picture was delivered in grey.
    pub fn is_grey(&self) -> bool {
        self.is_grey
    }
}

fn byte_count([width, height]: [u32; 2], channels: usize) -> usize {
    (width as usize).saturating_mul(height as usize).saturating_mul(channels)
}

impl From<Arc<RgbImage>> for Picture {
    fn from(pixels: Arc<RgbImage>) -> Self {
        Self { pixels, is_grey: false }
    }
}

impl From<&Arc<RgbImage>> for Picture {
    fn from(pixels: &Arc<RgbImage>) -> Self {
        pixels.clone().into()
    }
}

impl From<RgbImage> for Picture {
    fn from(pixels: RgbImage) -> Self {
        Arc::new(pixels).into()
    }
}

impl From<&RgbImage> for Picture {
    fn from(pixels: &RgbImage) -> Self {
        pixels.clone().into()
    }
}

impl From<&GrayImage> for Picture {
    fn from(grey: &GrayImage) -> Self {
        let pixels =
            RgbImage::from_fn(grey.width(), grey.height(), |u, v| Rgb([grey.get_pixel(u, v).0[0]; 3]));
        Self { pixels: Arc::new(pixels), is_grey: true }
    }
}

impl From<GrayImage> for Picture {
    fn from(grey: GrayImage) -> Self {
        Self::from(&grey)
    }
}

impl fmt::Debug for Picture {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size();
        let kind = if self.is_grey { "grey" } else { "RGB" };
        write!(formatter, "Picture({width} x {height}, {kind})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shared_picture_is_not_copied() {
        let pixels = Arc::new(RgbImage::new(4, 3));
        let picture = Picture::from(&pixels);
        assert!(Arc::ptr_eq(picture.pixels(), &pixels) && Arc::ptr_eq(picture.clone().pixels(), &pixels));
    }

    #[test]
    fn borrowed_buffers_become_the_pictures_that_they_hold() {
        let bytes: Vec<u8> = (0..24).collect();
        let picture = Picture::from_rgb([4, 2], &bytes).unwrap();
        assert_eq!((picture.size(), picture.is_grey()), ([4, 2], false));
        assert_eq!(picture.pixels().get_pixel(1, 1).0, [15, 16, 17]);

        let picture = Picture::from_grey([4, 2], &bytes[..8]).unwrap();
        assert!(picture.is_grey());
        assert_eq!(picture.pixels().get_pixel(1, 1).0, [5; 3]);
        let grey = GrayImage::from_raw(4, 2, bytes[..8].to_vec()).unwrap();
        assert_eq!(Picture::from(grey).pixels(), picture.pixels());
    }

    #[test]
    fn a_buffer_of_another_length_is_no_picture() {
        let error = Picture::from_rgb([4, 2], &[0; 8]).unwrap_err();
        assert_eq!(error, InvalidPicture { size: [4, 2], expected: 24, found: 8 });
        assert!(Picture::from_grey([4, 2], &[0; 24]).is_err());
        assert!(Picture::from_rgb([u32::MAX; 2], &[]).is_err());
    }
}
