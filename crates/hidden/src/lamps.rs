//! Uneven illumination of the hall.

use glam::{DVec2, Vec2};

use crate::{effect::Light, nominal::Nominal};

/// Uneven illumination: its strength, and the mean over the field that is subtracted from a spot.
pub struct Lamp {
    strength: f32,
    shape: Light,
    mean: f32,
    half_length_m: f32,
}

impl Lamp {
    /// Makes the illumination of a field.
    pub fn new(strength: f64, shape: Light, nominal: &Nominal) -> Self {
        let mut lamp = Self {
            strength: strength as f32,
            shape,
            mean: 0.0,
            half_length_m: nominal.field.length_m as f32 / 2.0,
        };
        let half = Vec2::new(nominal.field.length_m as f32, nominal.field.width_m as f32) / 2.0;
        let grid =
            |count: u8| (0..count).map(move |index| (f32::from(index) + 0.5) / f32::from(count) * 2.0 - 1.0);
        let places = grid(60).flat_map(|x| grid(40).map(move |y| half * Vec2::new(x, y)));
        lamp.mean = places.map(|place| lamp.brightness(place)).sum::<f32>() / 2400.0;
        lamp
    }

    fn brightness(&self, place: Vec2) -> f32 {
        match self.shape {
            Light::Gradient { direction_rad } => {
                place.dot(DVec2::from_angle(direction_rad).as_vec2()) / self.half_length_m
            }
            Light::Spot { center_m, sigma_m } => {
                (-0.5 * place.distance_squared(center_m.as_vec2()) / (sigma_m * sigma_m) as f32).exp()
            }
        }
    }

    /// Returns the factor on the light at a place.
    pub fn gain(&self, place: Vec2) -> f32 {
        (1.0 + self.strength * (self.brightness(place) - self.mean)).max(0.0)
    }
}
