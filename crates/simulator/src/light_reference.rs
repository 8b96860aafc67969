//! How bright lines and carpet usually are in a recording.

use glam::{DVec2, Vec3};
use reality_sim_core::{sequence::CameraSetup, statistics::median, warp::Picture};
use reality_sim_sensor::{Chain, SceneColors, Surface};
use reality_sim_synthesis::Archive;

use crate::{field_surfaces::FieldSurfaces, light::Light};

/// Encoded value from which a pixel may be clipped.
pub(crate) const CLIPPED: u8 = 250;
/// Reflectance of white lines, by which a white surface is brighter: that of white paint.
const LINE_REFLECTANCE: f32 = 0.8;
/// Number of recorded pictures that are read, spread over the recording.
const PICTURES: usize = 6;
/// Distance between the places on the carpet that are read, metres.
const SPACING_M: f64 = 0.1;
/// Distance from the picture's middle up to which places are read, half diagonals: lenses lose little light there.
const LARGEST_RADIUS: f64 = 0.4;
/// Least number of places for a median.
const LEAST_PLACES: usize = 50;

/// Brightness of lines and carpet as the camera records them, linear, without falloff and gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightReference {
    /// White lines.
    pub line_linear_rgb: Vec3,
    /// Carpet.
    pub carpet_linear_rgb: Vec3,
}

impl LightReference {
    /// Takes the photometry of the camera's file, and where it states none, what the archive's pictures show.
    pub(crate) fn new(archive: &Archive, setup: &CameraSetup, chain: &Chain) -> Self {
        let stated = SceneColors::new(setup, archive.field());
        let photometry = setup.photometry.as_ref();
        let is_stated = [
            photometry.is_some_and(|p| p.line_linear_rgb.is_some()),
            photometry.is_some_and(|p| p.carpet_linear_rgb.is_some()),
        ];
        let shown = if is_stated == [true; 2] { [None; 2] } else { shown(archive, chain) };
        let choose = |index: usize, stated: Vec3| match (is_stated[index], shown[index]) {
            (false, Some(shown)) => shown,
            _ => stated,
        };
        Self {
            line_linear_rgb: choose(0, stated.line_linear_rgb),
            carpet_linear_rgb: choose(1, stated.carpet_linear_rgb),
        }
    }

    /// Returns the light in which lines and carpet are as bright as this.
    pub fn light(&self) -> Light {
        Light { sky: self.line_linear_rgb / LINE_REFLECTANCE, ground: self.carpet_linear_rgb }
    }

    pub(crate) fn color(&self, surface: Surface) -> Vec3 {
        match surface {
            Surface::Line => self.line_linear_rgb,
            Surface::Carpet => self.carpet_linear_rgb,
        }
    }
}

/// Returns how bright lines and carpet are in the archive's pictures, where they show enough of them.
fn shown(archive: &Archive, chain: &Chain) -> [Option<Vec3>; 2] {
    let images = archive.images().len();
    let count = PICTURES.min(images);
    let mut values: [Vec<Vec3>; 2] = [Vec::new(), Vec::new()];
    for index in (0..count).map(|index| index * images / count) {
        // A picture that cannot be read is reported where it is drawn.
        if let Ok(picture) = archive.picture(index as u32) {
            read(archive, index as u32, &picture, chain, &mut values);
        }
    }
    values.map(|values| {
        let channel = |channel: usize| median(values.iter().map(|value| f64::from(value[channel]))) as f32;
        (values.len() >= LEAST_PLACES).then(|| Vec3::new(channel(0), channel(1), channel(2)))
    })
}

fn read(archive: &Archive, image: u32, picture: &Picture, chain: &Chain, values: &mut [Vec<Vec3>; 2]) {
    let camera = archive.camera_of(image);
    let pose = archive.images()[image as usize].pose;
    let half = archive.field().carpet_half_extent_m();
    let surfaces = FieldSurfaces::new(archive.field());
    let steps = (half / SPACING_M).floor().as_ivec2();
    let middle = DVec2::new(camera.cx, camera.cy);
    let farthest_px = LARGEST_RADIUS * 0.5 * f64::from(camera.width).hypot(f64::from(camera.height));
    let table = chain.linear_values();
    for (x, y) in (-steps.x..=steps.x).flat_map(|x| (-steps.y..=steps.y).map(move |y| (x, y))) {
        let point = SPACING_M * DVec2::new(x.into(), y.into());
        let Some(surface) = surfaces.at(point) else { continue };
        let Ok(pixel) = camera.project(pose.camera_from_world(point.extend(0.0))) else { continue };
        if pixel.distance(middle) > farthest_px {
            continue;
        }
        let pixel = pixel.round();
        let [red, green, blue, mask] =
            picture.pixels[pixel.y as usize * picture.width as usize + pixel.x as usize].to_le_bytes();
        if mask == Picture::SHOWN {
            let color = Vec3::from_array([red, green, blue].map(|value| table[usize::from(value)]));
            values[usize::from(surface == Surface::Carpet)].push(color);
        }
    }
}
