//! The light in the picture to which layers are added.

use glam::{DVec2, DVec3};
use image::RgbImage;
use reality_sim_core::{pose::CameraPose, statistics::median};
use reality_sim_sensor::{Development, Surface};

use crate::{
    field_surfaces::FieldSurfaces,
    light::Light,
    light_reference::{CLIPPED, LightReference},
};

/// Distances from a foot at which the ground's light is read, metres: light changes over metres, carpet from one hand's breadth
/// to the next.
const RING_RADII_M: [f64; 3] = [0.25, 0.5, 1.0];
/// Number of places on each ring.
const RING_PLACES: u32 = 16;
/// Least number of places that must be seen, of all 48: fewer may all lie on one worn line.
const LEAST_PLACES: usize = 8;
/// Range of the local light against the usual one: halls have lamps and shadows, but not beyond this; what is more is another
/// object that stands there.
const PLAUSIBLE: [f32; 2] = [0.3, 2.0];

/// Part of the difference, in logarithms, that is believed to be the light's: carpet rolls differ by ±10 % in reflectance, and the
/// light of a hall by about as much from one place to another, so that half of what is seen is either's.
const BELIEVED: f32 = 0.5;

/// Light in the picture to which layers are added.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SceneLight<'a> {
    pub(crate) reference: &'a LightReference,
    pub(crate) development: &'a Development,
    pub(crate) surfaces: &'a FieldSurfaces,
    /// Recorded picture; `None` where the light is taken to be the same everywhere.
    pub(crate) picture: Option<&'a RgbImage>,
    pub(crate) pose: CameraPose,
    pub(crate) gain: [f32; 3],
}

impl SceneLight<'_> {
    /// Returns the hall's light, wherever.
    pub(crate) fn usual(&self) -> Light {
        self.reference.light()
    }

    /// Returns the light at a place on the ground: the median of how bright the picture shows lines and carpet around it
    /// against how bright they usually are.
    pub(crate) fn at(&self, point_in_world: DVec2) -> Light {
        let usual = self.usual();
        let Some(picture) = self.picture.filter(|_| point_in_world.is_finite()) else { return usual };
        let turn = std::f64::consts::TAU / f64::from(RING_PLACES);
        let angles = (0..RING_PLACES).map(|place| turn * f64::from(place));
        let places =
            angles.flat_map(|angle_rad| RING_RADII_M.map(|radius| radius * DVec2::from_angle(angle_rad)));
        let ratios = places.filter_map(|offset| self.ratio(picture, point_in_world + offset));
        let ratios: Vec<f64> = ratios.map(f64::from).collect();
        if ratios.len() < LEAST_PLACES {
            return usual;
        }
        usual.scaled((median(ratios) as f32).clamp(PLAUSIBLE[0], PLAUSIBLE[1]).powf(BELIEVED))
    }

    /// Returns how bright the picture shows a point of the ground, against its usual brightness.
    fn ratio(&self, picture: &RgbImage, point_in_world: DVec2) -> Option<f32> {
        let surface = self.surfaces.at(point_in_world)?;
        let chain = self.development.chain();
        let point: DVec3 = self.pose.camera_from_world(point_in_world.extend(0.0));
        let pixel = chain.project_from_camera(point)?.round();
        chain.camera().check_inside(pixel).ok()?;
        let (u, v) = (pixel.x as u32, pixel.y as u32);
        let values = picture.get_pixel(u, v).0;
        if surface == Surface::Line && values.iter().any(|value| *value >= CLIPPED) {
            return None;
        }
        let falloff = self.development.falloff((v * picture.width() + u) as usize);
        let seen =
            (0..3).map(|channel| self.development.linear(values[channel]) / self.gain[channel].max(1e-3));
        let usual = self.reference.color(surface);
        Some(seen.sum::<f32>() / (falloff.max(1e-3) * usual.element_sum()).max(1e-6))
    }
}
