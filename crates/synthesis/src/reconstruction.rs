//! A picture at a pose, with where it came from.

use image::{GrayImage, Luma, Rgb, RgbImage};
use reality_sim_core::warp::{MAX_SOURCES, Origin, RayTable};
use reality_sim_db::index::ImageIndex;

/// The hues of [`Reconstruction::origin_picture`], sRGB, in the order of [`Reconstruction::used`]: told apart with any kind
/// of colour vision (Okabe and Ito, 2008).
pub const ORIGIN_HUES: [[u8; 3]; MAX_SOURCES] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [0, 114, 178],
    [213, 94, 0],
    [204, 121, 167],
    [160, 160, 160],
];

/// A recorded image that a reconstruction was made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UsedImage {
    /// Which, of [`crate::Archive::images`].
    pub image: ImageIndex,
    /// How far the picture moves from it to the pose asked for, root mean square pixels.
    pub distance_px: f64,
    /// The share of the pixels that came from it more than from any other.
    pub share: f64,
}

/// A picture at a pose that was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconstruction {
    /// The picture.
    pub picture: RgbImage,
    /// The method's name.
    pub method: &'static str,
    /// The images it was made from.
    pub used: Vec<UsedImage>,
    /// For every pixel, row by row, which of `used` it came from, and how far it can be trusted.
    pub origins: Vec<Origin>,
}

impl Reconstruction {
    pub(crate) fn new(
        picture: RgbImage,
        method: &'static str,
        images: impl Iterator<Item = (ImageIndex, f64)>,
        mut origins: Vec<Origin>,
        rays: &RayTable,
    ) -> Self {
        rays.mark_outside(&mut origins);
        let mut counts = [0_usize; 256];
        origins.iter().for_each(|origin| counts[usize::from(origin.source)] += 1);
        let seen = origins.len() - counts[usize::from(Origin::OUTSIDE)];
        let share = |source: usize| counts[source] as f64 / seen.max(1) as f64;
        let used = images.enumerate().map(|(source, (image, distance_px))| UsedImage {
            image,
            distance_px,
            share: share(source),
        });
        Self { picture, method, used: used.collect(), origins }
    }

    /// The share of the pixels that some recorded image shows; the others are smoothly filled or black. Pixels where the
    /// camera sees nothing do not count.
    pub fn covered(&self) -> f64 {
        let count = |of: fn(&Origin) -> bool| self.origins.iter().filter(|&origin| of(origin)).count() as f64;
        let outside = count(|origin| origin.source == Origin::OUTSIDE);
        count(|origin| origin.is_recorded()) / (self.origins.len() as f64 - outside).max(1.0)
    }

    /// How far each pixel can be trusted: white fully, black not at all.
    pub fn trust_picture(&self) -> GrayImage {
        self.drawn(|origin| Luma([origin.trust]))
    }

    /// Which image each pixel came from: a hue an image, the brighter the more it can be trusted; black from none.
    pub fn origin_picture(&self) -> RgbImage {
        self.drawn(|origin| match ORIGIN_HUES.get(usize::from(origin.source)) {
            Some(hue) => {
                Rgb(hue.map(|value| (u16::from(value) * (64 + u16::from(origin.trust) * 3 / 4) / 255) as u8))
            }
            None => Rgb([0; 3]),
        })
    }

    fn drawn<P: image::Pixel<Subpixel = u8>>(
        &self,
        color: impl Fn(&Origin) -> P,
    ) -> image::ImageBuffer<P, Vec<u8>> {
        let (width, height) = self.picture.dimensions();
        image::ImageBuffer::from_fn(width, height, |u, v| color(&self.origins[(v * width + u) as usize]))
    }
}
