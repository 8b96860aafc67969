//! Camera and field: lens, mount, colours and dimensions before anything is hidden.

use glam::DVec2;
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    field::FieldDimensions,
    sequence::{CameraSetup, Photometry},
};

use crate::{
    effect::Hidden,
    error::Error,
    lens::{Bend, Lens},
    random::Random,
};

/// Focal length in pixels of a lens like those of humanoid robots, at a width of 640 pixels.
const FOCAL_PX: f64 = 211.8;
const WIDTH_PX: f64 = 640.0;
const K: [f64; 4] = [-0.0663, 0.00994, -0.001_103, 0.000_054_6];

/// Camera and field.
#[derive(Debug, Clone)]
pub struct Nominal {
    /// The lens.
    pub lens: Lens,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Height of the projection centre above the carpet, metres.
    pub height_m: f64,
    /// Colours, gamma, noise, blur.
    pub light: Light,
    /// The field.
    pub field: FieldDimensions,
}

/// Conversion of light to pixel values; linear values have 1 as full scale.
#[derive(Debug, Clone, Copy)]
pub struct Light {
    /// Linear colour of the lines.
    pub line_rgb: [f64; 3],
    /// Mean linear colour of the carpet.
    pub carpet_rgb: [f64; 3],
    /// Gamma: a pixel value is full scale times the linear value to the power of 1 / gamma.
    pub gamma: f64,
    /// Variance of the noise per unit of the linear value.
    pub noise_shot: f64,
    /// Standard deviation of the noise without light.
    pub noise_read: f64,
    /// Standard deviation of the Gaussian blur without the pixel's own aperture, pixels.
    pub psf_sigma_px: f64,
}

impl Nominal {
    /// Draws the camera from the seed around that of one robot, on a field of 6 × 4 m.
    pub fn new(seed: u64, size: [u32; 2]) -> Self {
        let random = &mut Random::stream(seed, "nominal", 0);
        let [width, height] = size.map(f64::from);
        let scale = width / WIDTH_PX;
        let bend = random.between(0.93, 1.07);
        let center = DVec2::new(width - 1.0, height - 1.0) / 2.0;
        let lens = Lens {
            focal_px: rounded(FOCAL_PX * scale * random.between(0.96, 1.04), 1e6),
            center_px: (center + scale * DVec2::new(random.between(-3.0, 3.0), random.between(-3.0, 3.0)))
                .map(|value| rounded(value, 1e3)),
            bend: Bend::Fisheye(K.map(|k| rounded(k * bend, 1e9))),
            p: [0.0; 2],
        };
        let mut near = |value: f64| rounded(value * random.between(0.95, 1.05), 1e4);
        let light = Light {
            line_rgb: [near(0.65), near(0.665), near(0.648)],
            carpet_rgb: [near(0.041), near(0.144), near(0.051)],
            gamma: 2.2,
            noise_shot: 0.0015,
            noise_read: 0.004,
            psf_sigma_px: 0.5,
        };
        let height_m = near(0.52);
        Self { lens, size, height_m, light, field: kid_size_field() }
    }

    /// Returns all that can be said of the conversion of light.
    pub fn photometry(&self) -> Photometry {
        let light = &self.light;
        Photometry {
            line_linear_rgb: Some(light.line_rgb),
            carpet_linear_rgb: Some(light.carpet_rgb),
            black_level: Some(0.0),
            noise_shot: Some(light.noise_shot),
            noise_read: Some(light.noise_read),
            psf_sigma_px: Some(light.psf_sigma_px),
            ..Photometry::of_gamma(light.gamma)
        }
    }

    /// Returns the content of `camera.toml`.
    pub fn setup(&self, photometry: Photometry) -> Result<CameraSetup, Error> {
        let Lens { focal_px, center_px, bend, p: [p1, p2] } = self.lens;
        let intrinsics = [focal_px, focal_px, center_px.x, center_px.y];
        let lens = match bend {
            Bend::Fisheye(k) => Distortion::OpencvFisheye(OpencvFisheye { k }),
            Bend::Perspective([0.0, 0.0]) if p1 == 0.0 && p2 == 0.0 => Distortion::Pinhole,
            Bend::Perspective([k1, k2]) => Distortion::Opencv(Opencv { k1, k2, p1, p2, k3: 0.0 }),
        };
        let camera = Camera::new(self.size, intrinsics, lens).map_err(|_| Error::Recipe {
            name: "size",
            value: f64::from(self.size[0]),
            rule: "a number of pixels that a camera can have",
        })?;
        Ok(CameraSetup { camera, mount_height_m: self.height_m, photometry: Some(photometry) })
    }

    /// Returns whether an effect can be hidden by other values in the files beside the same pictures.
    pub fn can_lack(&self, effect: &Hidden) -> bool {
        match effect {
            Hidden::TangentialDistortion { .. } => matches!(self.lens.bend, Bend::Perspective(_)),
            Hidden::RadialDistortion { .. }
            | Hidden::PrincipalPoint { .. }
            | Hidden::FocalLength { .. }
            | Hidden::MountPitch { .. }
            | Hidden::MountRoll { .. }
            | Hidden::CameraHeight { .. }
            | Hidden::CameraYaw { .. }
            | Hidden::CameraOffset { .. }
            | Hidden::GaitSway { .. }
            | Hidden::TimeOffset { .. }
            | Hidden::CarpetReflectance { .. }
            | Hidden::LineReflectance { .. }
            | Hidden::FieldDimensions { .. } => true,
            _ => false,
        }
    }

    /// Takes an effect out of the values, so that these lack it.
    pub fn take_out(&mut self, effect: &Hidden) {
        match *effect {
            Hidden::RadialDistortion { k } => self.lens.bend.add(k.map(|k| -k)),
            Hidden::TangentialDistortion { p1, p2 } => {
                self.lens.p = [self.lens.p[0] - p1, self.lens.p[1] - p2];
            }
            Hidden::PrincipalPoint { dx_px, dy_px } => self.lens.center_px -= DVec2::new(dx_px, dy_px),
            Hidden::FocalLength { scale } => self.lens.focal_px /= 1.0 + scale,
            Hidden::CameraHeight { height_m } => self.height_m -= height_m,
            Hidden::CameraOffset { up_m, .. } => self.height_m -= up_m,
            Hidden::FieldDimensions { length_m, width_m } => {
                self.field.length_m -= length_m;
                self.field.width_m -= width_m;
            }
            _ => {}
        }
    }
}

/// Rounds to a multiple of 1 / `per_unit`: calibration files have few digits.
pub fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}

/// Returns the field of 6 × 4 m of the Humanoid League of 2010.
pub fn kid_size_field() -> FieldDimensions {
    FieldDimensions {
        name: "humanoid-kidsize-2010".to_owned(),
        length_m: 6.0,
        width_m: 4.0,
        line_width_m: 0.05,
        border_strip_m: 0.7,
        goal_area_length_m: 0.6,
        goal_area_width_m: 2.2,
        penalty_mark_distance_m: 1.8,
        center_circle_diameter_m: 1.2,
        goal_width_m: 1.5,
        goal_height_m: 0.8,
        goal_post_diameter_m: 0.1,
        penalty_area_length_m: None,
        penalty_area_width_m: None,
        goal_srgb_positive_x: None,
        goal_srgb_negative_x: None,
    }
}
