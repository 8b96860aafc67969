//! Reconstructed picture at a pose, and the origin of its pixels.

use image::{GrayImage, Luma, Rgb, RgbImage};
use rayon::prelude::*;
use reality_sim_core::warp::{MAX_SOURCES, Origin, RayTable};
use reality_sim_db::index::ImageIndex;

/// Hues of [`Reconstruction::origin_picture`], sRGB, in the order of [`Reconstruction::used`]: distinguishable with any
/// kind of colour vision (Okabe and Ito, 2008).
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

/// Hue of ground as many pictures together saw it, see [`Origin::GROUND`].
const GROUND_HUE: [u8; 3] = [255, 255, 255];

/// Recorded image that a reconstruction was made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UsedImage {
    /// Index of the image in [`crate::Archive::images`].
    pub image: ImageIndex,
    /// Distance that the picture moves from the image to the requested pose, root mean square pixels.
    pub distance_px: f64,
    /// Share of the pixels that came mainly from this image.
    pub share: f64,
}

/// Images that a picture was made from, and the origin of its pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// Name of the method.
    pub method: &'static str,
    /// Images that the picture was made from.
    pub used: Vec<UsedImage>,
    /// Source in `used` and trust of every pixel, row by row.
    pub origins: Vec<Origin>,
    covered: f64,
}

/// Reconstructed picture at a requested pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconstruction {
    /// Reconstructed picture.
    pub picture: RgbImage,
    /// Name of the method.
    pub method: &'static str,
    /// Images that the picture was made from.
    pub used: Vec<UsedImage>,
    /// Source in `used` and trust of every pixel, row by row.
    pub origins: Vec<Origin>,
    covered: f64,
}

impl Provenance {
    /// Counts the pixels that came from each image, and marks those that the camera cannot see.
    pub(crate) fn new(
        method: &'static str,
        images: impl Iterator<Item = (ImageIndex, f64)>,
        mut origins: Vec<Origin>,
        rays: &RayTable,
    ) -> Self {
        rays.mark_outside(&mut origins);
        let counts = Counts::new(&origins);
        let used = images.enumerate().map(|(source, (image, distance_px))| UsedImage {
            image,
            distance_px,
            share: counts.share(source),
        });
        Self { method, used: used.collect(), origins, covered: counts.covered() }
    }

    /// Returns the share of the pixels that some recorded image shows, see [`Reconstruction::covered`].
    pub fn covered(&self) -> f64 {
        self.covered
    }
}

/// Number of pixels from every source.
struct Counts([usize; 256]);

/// Pixels that one task counts.
const PIXELS_A_TASK: usize = 1 << 15;

impl Counts {
    fn new(origins: &[Origin]) -> Self {
        // Neighbouring pixels mostly have the same source: runs are counted, since a counter that was just written is slow to read.
        let count = |origins: &[Origin]| {
            let mut counts = [0; 256];
            for run in origins.chunk_by(|a, b| a.source == b.source) {
                counts[usize::from(run[0].source)] += run.len();
            }
            counts
        };
        let sum = |a: [usize; 256], b: [usize; 256]| std::array::from_fn(|source| a[source] + b[source]);
        Self(origins.par_chunks(PIXELS_A_TASK).map(count).reduce(|| [0; 256], sum))
    }

    /// Returns the number of pixels at which the camera sees something.
    fn seen(&self) -> usize {
        self.0.iter().sum::<usize>() - self.0[usize::from(Origin::OUTSIDE)]
    }

    fn share(&self, source: usize) -> f64 {
        self.0[source] as f64 / self.seen().max(1) as f64
    }

    fn covered(&self) -> f64 {
        let unseen = self.0[usize::from(Origin::NOWHERE)];
        (self.seen() - unseen) as f64 / self.seen().max(1) as f64
    }
}

impl Reconstruction {
    pub(crate) fn new(picture: RgbImage, Provenance { method, used, origins, covered }: Provenance) -> Self {
        Self { picture, method, used, origins, covered }
    }

    /// Share of the pixels that some recorded image shows; the others are filled smoothly or black. Pixels where the
    /// camera sees nothing do not count.
    pub fn covered(&self) -> f64 {
        self.covered
    }

    /// Draws how far each pixel can be trusted: white means fully, black not at all.
    pub fn trust_picture(&self) -> GrayImage {
        self.drawn(|origin| Luma([origin.trust]))
    }

    /// Draws which image each pixel came from: one hue per image, brighter where it can be trusted more; white for ground as many
    /// images together saw it, black where there is none.
    pub fn origin_picture(&self) -> RgbImage {
        let hue = |source: u8| match source {
            Origin::GROUND => Some(&GROUND_HUE),
            source => ORIGIN_HUES.get(usize::from(source)),
        };
        self.drawn(|origin| match hue(origin.source) {
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
