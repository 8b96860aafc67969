//! Recorded pictures at small size: less noise, and less memory.

use std::{collections::BTreeMap, sync::Arc};

use image::{
    RgbImage,
    imageops::{FilterType, resize},
};
use rayon::prelude::*;
use reality_sim_core::{
    camera::{Camera, KernelCamera},
    warp::{Picture, Placement, RayTable, Source},
};

use crate::{Archive, SynthesisError};

/// Largest width at which pictures are compared, pixels. Half the size of the usual 640 pixels averages four of them, which halves
/// the noise, and leaves a ball at 4 m three pixels wide.
const WIDTH: u32 = 320;

/// Camera with fewer pixels.
pub(crate) struct ShrunkCamera {
    pub camera: Camera,
    pub kernel: KernelCamera,
    pub rays: RayTable,
}

/// Cameras of an archive with fewer pixels, by their ids.
pub(crate) struct ShrunkCameras(BTreeMap<i64, ShrunkCamera>);

impl ShrunkCameras {
    /// Shrinks the cameras that took the archive's images.
    pub fn new(archive: &Archive) -> Self {
        let mut cameras = BTreeMap::new();
        for (image, record) in archive.images().iter().enumerate() {
            cameras
                .entry(record.camera_id)
                .or_insert_with(|| ShrunkCamera::new(archive.camera_of(image as u32)));
        }
        Self(cameras)
    }

    /// Reads an image at small size. It does not stay in the archive's cache.
    pub fn read(&self, archive: &Archive, image: usize) -> Result<ShrunkPicture<'_>, SynthesisError> {
        let record = &archive.images()[image];
        let camera = &self.0[&record.camera_id];
        let picture = archive.decoded(image as u32)?;
        Ok(ShrunkPicture {
            image,
            camera,
            placement: Placement::new(record.pose),
            picture: Arc::new(Picture::from(&shrunk(picture, [camera.camera.width, camera.camera.height]))),
            gain: [1.0; 3],
        })
    }
}

impl ShrunkCamera {
    fn new(camera: &Camera) -> Self {
        let shrink = f64::from(camera.width.div_ceil(WIDTH));
        let size =
            [camera.width, camera.height].map(|side| (f64::from(side) / shrink).round().max(1.0) as u32);
        // A valid camera stays valid when its picture shrinks.
        let small = camera.resized(size).unwrap_or_else(|_| camera.clone());
        Self { kernel: KernelCamera::new(&small), rays: RayTable::new(&small), camera: small }
    }
}

/// Image of an archive at small size.
#[derive(Clone)]
pub(crate) struct ShrunkPicture<'a> {
    /// Number of the image in the archive.
    pub image: usize,
    pub camera: &'a ShrunkCamera,
    pub placement: Placement,
    pub picture: Arc<Picture>,
    /// Factors for red, green and blue that make it as bright as the others.
    pub gain: [f32; 3],
}

impl ShrunkPicture<'_> {
    /// Makes it a source for a warp.
    pub fn source(&self) -> Source<'_> {
        Source {
            camera: &self.camera.kernel,
            placement: self.placement,
            picture: &self.picture,
            gain: self.gain,
        }
    }

    /// Returns the colour of a pixel, as bright as in the other pictures.
    pub fn color(&self, pixel: usize) -> [f32; 3] {
        let [red, green, blue, _] = self.picture.pixels[pixel].to_le_bytes().map(f32::from);
        [red * self.gain[0], green * self.gain[1], blue * self.gain[2]]
    }
}

/// Shrinks a picture: by averages where its size is a multiple of the smaller one.
fn shrunk(picture: RgbImage, [width, height]: [u32; 2]) -> RgbImage {
    let factor = picture.width() / width.max(1);
    match factor {
        1 if picture.dimensions() == (width, height) => picture,
        2.. if picture.dimensions() == (factor * width, factor * height) => averaged(&picture, factor),
        _ => resize(&picture, width, height, FilterType::Triangle),
    }
}

/// Averages squares of this many pixels a side.
fn averaged(picture: &RgbImage, factor: u32) -> RgbImage {
    let (width, height) = (picture.width() / factor, picture.height() / factor);
    let mut small = RgbImage::new(width, height);
    let side = factor as usize;
    let (stride, pixels) = (3 * picture.width() as usize, (side * side) as u32);
    let rows = small.par_chunks_mut(3 * width as usize).with_min_len(64).enumerate();
    rows.for_each(|(row, averages)| {
        let mut sums = vec![0_u32; averages.len()];
        for line in picture.chunks(stride).skip(row * side).take(side) {
            for (sums, square) in sums.as_chunks_mut::<3>().0.iter_mut().zip(line.chunks(3 * side)) {
                for pixel in square.as_chunks::<3>().0 {
                    sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += u32::from(*value));
                }
            }
        }
        averages
            .iter_mut()
            .zip(sums)
            .for_each(|(average, sum)| *average = ((sum + pixels / 2) / pixels) as u8);
    });
    small
}
