//! The light that a surface sends to the camera.

use glam::{DVec3, Vec3};

use crate::{layer::Sphere, light::Light, shadow::light_left};

/// Exponent of the highlight: half of it is left 15° beside its middle. Found on the even probes of `docs/simulator.md`, where
/// the sharper lobe of exponent 60 explains nothing more.
const HIGHLIGHT_EXPONENT: i32 = 20;

/// How a body looks: its light, its colour, its gloss, and what shades its lower side.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a> {
    /// Light where it is.
    pub light: Light,
    /// Factor of the reflectances of its surface, in red, green and blue.
    pub reflectance: Vec3,
    /// Share of the light from above that it mirrors: 0 for a matt body.
    pub gloss: f32,
    /// Spheres that take light from the ground, of which its lower side then gets less.
    pub occluders: &'a [Sphere],
}

impl Shading<'_> {
    /// Makes a matt body of a surface's own colours.
    pub fn matt(light: Light) -> Self {
        Self { light, reflectance: Vec3::ONE, gloss: 0.0, occluders: &[] }
    }

    /// Returns the light that a point with this outward unit normal sends to the camera. The highlight is Blinn's (1977), of light
    /// from straight above.
    pub(crate) fn color(&self, point: DVec3, normal: Vec3, reflectance: Vec3, camera: DVec3) -> Vec3 {
        let light = Light { ground: self.ground_left(point, normal) * self.light.ground, ..self.light };
        let matt = self.reflectance * reflectance * light.on(normal);
        if self.gloss == 0.0 {
            return matt;
        }
        let half = ((camera - point).normalize_or_zero().as_vec3() + Vec3::Z).normalize_or_zero();
        matt + self.gloss * normal.dot(half).max(0.0).powi(HIGHLIGHT_EXPONENT) * self.light.sky
    }

    /// Returns the share of the light that is left on the ground towards which a lower side faces.
    fn ground_left(&self, point: DVec3, normal: Vec3) -> f32 {
        let normal = normal.as_dvec3();
        if normal.z >= 0.0 || point.z <= 0.0 {
            return 1.0;
        }
        let on_ground = (point - point.z / normal.z * normal).truncate();
        self.occluders.iter().map(|sphere| light_left(*sphere, on_ground) as f32).product()
    }
}
