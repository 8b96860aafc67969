//! The hall's light, as the camera records it.
//!
//! Light falls from above, evenly from all sides, and comes back from the carpet: a matt surface with the unit normal `n` and
//! reflectance `ρ` sends `ρ · (sky · (1 + n_z) / 2 + ground · (1 − n_z) / 2)` to the camera, where `sky` is what a white
//! surface that faces up would send, and `ground` is what the carpet sends (hemisphere lighting, Parent et al. 1989 and every
//! renderer since).

use glam::Vec3;

/// Light at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Linear red, green and blue of a white surface that faces up: the light from above.
    pub sky: Vec3,
    /// Linear red, green and blue of the ground: the light from below.
    pub ground: Vec3,
}

impl Light {
    /// Returns the light that a white matt surface with this unit normal sends.
    pub fn on(&self, normal_in_world: Vec3) -> Vec3 {
        let up = normal_in_world.z.clamp(-1.0, 1.0);
        0.5 * (1.0 + up) * self.sky + 0.5 * (1.0 - up) * self.ground
    }

    pub(crate) fn scaled(self, factor: f32) -> Self {
        Self { sky: factor * self.sky, ground: factor * self.ground }
    }
}
