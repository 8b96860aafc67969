//! Pictures as a camera without distortion would have taken them.

use std::{io, path::Path};

use glam::{DVec2, DVec3};
use image::{ExtendedColorType, ImageEncoder, Rgb, RgbImage, Rgba, RgbaImage, codecs::png::PngEncoder};
use reality_sim_core::camera::{Camera, Distortion, InvalidCamera};

use crate::model_error::{ModelError, ModelFault};

/// Largest default field of view across the picture, radians. Chosen: 100°; beyond it, a plane picture stretches its corners
/// to more than three times their size.
const LARGEST_DEFAULT_FOV_RAD: f64 = 100.0 * std::f64::consts::PI / 180.0;

/// Directions, counted from the axis to one side, that are tried in the search for a camera's field of view.
const FOV_STEPS: u32 = 2000;

/// What fills the pixels that the recorded picture does not show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Border {
    /// Black, in a JPEG.
    #[default]
    Black,
    /// Transparent, in a PNG.
    Transparent,
}

/// How pictures are undistorted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Undistortion {
    /// Field of view across the width of the result, radians, above 0 and below π. By default what the camera sees across its
    /// width, and at most 100°.
    pub fov_rad: Option<f64>,
    /// What fills the pixels that the recorded picture does not show.
    pub border: Border,
}

impl Undistortion {
    /// Prepares the undistortion of one camera's pictures. The size of the picture stays. Fails if no plane picture has the field
    /// of view that is asked for.
    pub fn of_camera(&self, camera: &Camera) -> Result<Undistorter, InvalidCamera> {
        let pinhole = self.pinhole(camera)?;
        let pixels = (0..pinhole.height).flat_map(|v| (0..pinhole.width).map(move |u| (u, v)));
        let sources = pixels.map(|(u, v)| source(camera, &pinhole, u, v)).collect();
        Ok(Undistorter { pinhole, border: self.border, recorded: camera.clone(), sources })
    }

    /// Returns the camera without distortion: its principal point is the middle of the picture, its pixels are square.
    fn pinhole(&self, camera: &Camera) -> Result<Camera, InvalidCamera> {
        let fov_rad = self.fov_rad.unwrap_or_else(|| fov_across_rad(camera).min(LARGEST_DEFAULT_FOV_RAD));
        let [width, height] = [camera.width, camera.height].map(f64::from);
        let focal_px = 0.5 * width / (0.5 * fov_rad).tan();
        let intrinsics = [focal_px, focal_px, 0.5 * (width - 1.0), 0.5 * (height - 1.0)];
        Camera::new([camera.width, camera.height], intrinsics, Distortion::Pinhole)
    }
}

/// Returns the angle that a camera sees across its width, through the middle of the picture, radians.
fn fov_across_rad(camera: &Camera) -> f64 {
    let side = |sign: f64| {
        let angles =
            (1..=FOV_STEPS).map(|step| 0.5 * std::f64::consts::PI * f64::from(step) / f64::from(FOV_STEPS));
        let is_seen = |angle: &f64| camera.project(DVec3::new(sign * angle.sin(), 0.0, angle.cos())).is_ok();
        angles.take_while(is_seen).last().unwrap_or(0.0)
    };
    2.0 * side(1.0).min(side(-1.0)).max(0.01)
}

/// Returns the recorded picture's place that a pixel of the undistorted picture shows.
fn source(camera: &Camera, pinhole: &Camera, u: u32, v: u32) -> Option<DVec2> {
    let direction = pinhole.unproject(DVec2::new(f64::from(u), f64::from(v))).ok()?;
    camera.project(direction).ok()
}

/// Undistortion of one camera's pictures.
#[derive(Debug, Clone)]
pub struct Undistorter {
    /// Camera without distortion that sees the result.
    pub pinhole: Camera,
    /// What fills the pixels that the recorded picture does not show.
    pub border: Border,
    recorded: Camera,
    /// Place in the recorded picture of every pixel of the result, row by row.
    sources: Vec<Option<DVec2>>,
}

impl Undistorter {
    /// Returns width and height of the recorded pictures, pixels.
    pub fn recorded_size(&self) -> [u32; 2] {
        [self.recorded.width, self.recorded.height]
    }

    /// Returns a picture undistorted, with black where nothing was recorded.
    pub fn picture(&self, recorded: &RgbImage) -> RgbImage {
        RgbImage::from_fn(self.pinhole.width, self.pinhole.height, |u, v| {
            self.at(recorded, u, v).unwrap_or(Rgb([0; 3]))
        })
    }

    /// Returns a picture undistorted, as a PNG that is transparent where nothing was recorded.
    pub(crate) fn transparent_png(&self, path: &Path, recorded: &RgbImage) -> Result<Vec<u8>, ModelError> {
        let picture = RgbaImage::from_fn(self.pinhole.width, self.pinhole.height, |u, v| {
            self.at(recorded, u, v).map_or(Rgba([0; 4]), |Rgb([r, g, b])| Rgba([r, g, b, u8::MAX]))
        });
        let mut bytes = Vec::new();
        let (width, height) = picture.dimensions();
        PngEncoder::new(&mut bytes)
            .write_image(&picture, width, height, ExtendedColorType::Rgba8)
            .map_err(|error| ModelError::of_file(path, ModelFault::Unwritable(io::Error::other(error))))?;
        Ok(bytes)
    }

    fn at(&self, recorded: &RgbImage, u: u32, v: u32) -> Option<Rgb<u8>> {
        let place = self.sources[(v * self.pinhole.width + u) as usize]?;
        Some(bilinear(recorded, place))
    }
}

/// Returns a picture's colour between its pixels. The place lies inside the picture.
fn bilinear(picture: &RgbImage, place: DVec2) -> Rgb<u8> {
    let corner = place.floor();
    let part = place - corner;
    let (u, v) = (corner.x as u32, corner.y as u32);
    let (right, below) = ((u + 1).min(picture.width() - 1), (v + 1).min(picture.height() - 1));
    let pixels = [(u, v), (right, v), (u, below), (right, below)].map(|(u, v)| picture.get_pixel(u, v).0);
    let weights =
        [(1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y];
    Rgb([0, 1, 2].map(|channel| {
        let value: f64 =
            pixels.iter().zip(weights).map(|(pixel, weight)| weight * f64::from(pixel[channel])).sum();
        value.round() as u8
    }))
}
