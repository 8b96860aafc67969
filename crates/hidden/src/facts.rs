//! Facts of a recipe's world, for tables.

use crate::{lens::Bend, recipe::Recipe};

/// Facts of a recipe's world.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Model of the lens, as in `camera.toml`.
    pub lens: &'static str,
    /// Angle seen across the picture, radians.
    pub across_rad: f64,
    /// Height of the camera, metres.
    pub height_m: f64,
    /// Pictures per second.
    pub rate_hz: f64,
    /// Length and width of the field, metres.
    pub field_m: [f64; 2],
    /// Variance of the noise per unit of the linear value.
    pub noise_shot: f64,
}

impl Recipe {
    /// Returns facts of the recipe's world.
    pub fn facts(&self) -> Facts {
        let setting = self.setting();
        let nominal = &setting.nominal;
        let lens = match nominal.lens.bend {
            Bend::Fisheye(_) => "OPENCV_FISHEYE",
            Bend::Perspective([0.0, 0.0]) => "PINHOLE",
            Bend::Perspective(_) => "OPENCV",
        };
        let [width, height] = nominal.size.map(f64::from);
        let largest_radius = nominal.lens.largest_radius();
        let ray = |x: f64| nominal.lens.ray(glam::DVec2::new(x, height / 2.0), largest_radius);
        let across_rad = ray(0.0).zip(ray(width - 1.0)).map_or(f64::NAN, |(left, right)| {
            let angle = |ray: glam::DVec3| ray.x.atan2(ray.z).abs();
            angle(left) + angle(right)
        });
        Facts {
            lens,
            across_rad,
            height_m: nominal.height_m,
            rate_hz: setting.rate_hz,
            field_m: [nominal.field.length_m, nominal.field.width_m],
            noise_shot: nominal.light.noise_shot,
        }
    }
}
