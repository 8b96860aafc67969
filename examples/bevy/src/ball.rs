//! A ball of Bevy's world.

use bevy::prelude::*;
use reality_sim::{glam, simulator::Ball};

use crate::axes::world_from_bevy;

/// Ball that every [`RealityCamera`](crate::RealityCamera) sees. Its centre is the place of its entity, its name that of the entity.
#[derive(Debug, Clone, PartialEq, Component)]
#[require(Transform)]
pub struct RealityBall {
    /// Radius, metres; the entity's scale does not change it.
    pub radius_m: f64,
    /// Share of the light that its surface sends back, 0 to 1.
    pub reflectance: LinearRgba,
    /// Share of the light from above that its surface mirrors: 0 for a matt ball.
    pub gloss: f32,
    /// Velocity along Bevy's axes, metres per second. It blurs the ball where the camera's model has an exposure.
    pub velocity_m_s: Vec3,
}

impl RealityBall {
    /// Makes a matt ball at rest.
    pub fn new(radius_m: f64, reflectance: impl Into<LinearRgba>) -> Self {
        Self { radius_m, reflectance: reflectance.into(), gloss: 0.0, velocity_m_s: Vec3::ZERO }
    }

    /// Returns the ball as cameras draw it.
    pub(crate) fn layer(&self, place: &GlobalTransform, name: &str) -> Ball {
        Ball {
            name: name.to_owned(),
            center_in_world: world_from_bevy(place.translation()),
            radius_m: self.radius_m,
            reflectance: glam::Vec3::from_array(self.reflectance.to_f32_array_no_alpha()),
            gloss: self.gloss,
            velocity_in_world: world_from_bevy(self.velocity_m_s),
        }
    }
}
