//! Recorded pictures as a camera with other effects would have recorded them: their light is recovered by the nominal camera
//! and goes through the stages of the other one.

use glam::{DVec2, Vec3};
use image::{Rgb, RgbImage};
use rayon::prelude::*;
use reality_sim_core::pose::CameraPose;

use crate::{Chain, blur::blurred, light::Light, noise::noise_stream, sharpening::sharpened};

/// Places at which two cameras are compared, as fractions of the picture's size.
const COMPARED: [[f64; 2]; 4] = [[0.5, 0.5], [0.0, 0.0], [0.9, 0.1], [0.3, 0.8]];

/// Two cameras that record the same light: the one that recorded a picture, and another one.
#[derive(Debug, Clone, Copy)]
pub struct Redevelopment<'a> {
    /// Camera that recorded the pictures.
    pub recorded: &'a Chain,
    /// Camera as which they are developed anew. It has the same lens and moves in the same way.
    pub other: &'a Chain,
}

impl Redevelopment<'_> {
    /// Whether the two cameras record different values, somewhere in the picture at one of these times.
    pub fn changes(&self, times_s: &[f64]) -> bool {
        let camera = self.recorded.camera();
        let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
        let at = |chain: &Chain, place: [f64; 2], time_s: f64| {
            let pixel = DVec2::from(place) * size;
            let ground = Some(3.0 * (DVec2::from(place) - 0.5));
            let values = [0.02, 0.2, 0.7].map(|linear| (chain.respond(linear), chain.encode(linear)));
            (chain.light(time_s, pixel, ground), chain.psf_variance_px2(pixel), values)
        };
        let differs = |place: [f64; 2]| {
            times_s.iter().any(|time_s| at(self.recorded, place, *time_s) != at(self.other, place, *time_s))
        };
        let of_picture = |chain: &Chain| [chain.glare(), chain.sharpening()];
        self.recorded.noise() != self.other.noise()
            || of_picture(self.recorded) != of_picture(self.other)
            || self.recorded.magnification() != self.other.magnification()
            || COMPARED.into_iter().any(differs)
    }

    /// Returns a recorded picture as the other camera would have recorded it. `seed` is that of the noise that it adds.
    pub fn picture(&self, picture: &RgbImage, pose: CameraPose, time_s: f64, seed: u64) -> RgbImage {
        let (width, height) = picture.dimensions();
        let light = self.magnified(self.light_of(picture));
        let light = self.lit(light, pose, time_s);
        let added_px2 = |pixel: DVec2| {
            (self.other.psf_variance_px2(pixel) - self.recorded.psf_variance_px2(pixel)).max(0.0)
        };
        let is_blurred = COMPARED.iter().any(|place| {
            added_px2(DVec2::from(*place) * DVec2::new(f64::from(width), f64::from(height))) > 0.0
        });
        let light = if is_blurred { blurred(light, added_px2) } else { light };
        // The mean light has the first camera's share already.
        let [recorded_share, other_share] = [self.recorded, self.other].map(Chain::glare);
        let light = light.veiled(((other_share - recorded_share) / (1.0 + recorded_share)) as f32);
        let stream = noise_stream(seed, time_s, 0);
        let mut made = RgbImage::new(width, height);
        let rows: Vec<Vec<Rgb<u8>>> = light
            .rows()
            .enumerate()
            .map(|(v, row)| {
                let pixel = |(u, light): (usize, &Vec3)| {
                    let at = DVec2::new(u as f64, v as f64);
                    let normals = stream.normals(v as u32 * width + u as u32);
                    let gain = self.gain(time_s, at, None).to_array().map(f64::from);
                    let kept = kept_by_blur(added_px2(at));
                    Rgb([0, 1, 2].map(|channel| {
                        self.encoded(f64::from(light[channel]), gain[channel], kept, normals[channel])
                    }))
                };
                row.iter().enumerate().map(pixel).collect()
            })
            .collect();
        made.pixels_mut().zip(rows.into_iter().flatten()).for_each(|(to, from)| *to = from);
        let amount = self.other.sharpening() - self.recorded.sharpening();
        if amount == 0.0 { made } else { sharpened(&made, amount) }
    }

    /// Returns the light of which the first camera recorded a picture.
    fn light_of(&self, picture: &RgbImage) -> Light {
        let table = self.recorded.linear_values();
        let mut light = Light::dark([picture.width(), picture.height()]);
        light.rows_mut().enumerate().for_each(|(v, row)| {
            for (u, light) in row.iter_mut().enumerate() {
                let pixel = picture.get_pixel(u as u32, v as u32).0;
                *light = Vec3::from_array(pixel.map(|value| table[usize::from(value)]));
            }
        });
        light
    }

    /// Magnifies the colours as the other camera does, about the principal point.
    fn magnified(&self, light: Light) -> Light {
        let [recorded, other] = [self.recorded, self.other].map(Chain::magnification);
        if recorded == other {
            return light;
        }
        let camera = self.recorded.camera();
        let mut magnified = Light::dark([camera.width, camera.height]);
        magnified.rows_mut().enumerate().for_each(|(v, row)| {
            for (u, to) in row.iter_mut().enumerate() {
                let from_middle = DVec2::new(u as f64 - camera.cx, v as f64 - camera.cy);
                *to = Vec3::from_array([0, 1, 2].map(|channel| {
                    let from = from_middle * recorded[channel] / other[channel];
                    interpolated(&light, from + DVec2::new(camera.cx, camera.cy))[channel]
                }));
            }
        });
        magnified
    }

    /// Changes the light on the ground, its falloff and the gain to those of the other camera.
    fn lit(&self, mut light: Light, pose: CameraPose, time_s: f64) -> Light {
        let camera = self.recorded.camera();
        let is_uneven = self.recorded.has_uneven_light() || self.other.has_uneven_light();
        light.rows_mut().enumerate().for_each(|(v, row)| {
            for (u, light) in row.iter_mut().enumerate() {
                let pixel = DVec2::new(u as f64, v as f64);
                let ground = if is_uneven { camera.unproject_to_ground(pose, pixel).ok() } else { None };
                *light *= self.gain(time_s, pixel, ground);
            }
        });
        light
    }

    /// Returns the factors from the light of the first camera to that of the other one.
    fn gain(&self, time_s: f64, pixel: DVec2, ground: Option<DVec2>) -> Vec3 {
        let [recorded, other] = [self.recorded, self.other].map(|chain| chain.light(time_s, pixel, ground));
        Vec3::from_array([0, 1, 2].map(|channel| (other[channel] / recorded[channel].max(1e-6)) as f32))
    }

    /// Records light with as much noise as the other camera has. `gain` is the light's factor from the first camera to the other
    /// one, `kept` the part of the first one's variance that a blur has left, `normal` a standard normal number.
    fn encoded(&self, linear: f64, gain: f64, kept: f64, normal: f64) -> u8 {
        let wanted = self.other.noise().variance(linear);
        let left = kept * gain * gain * self.recorded.noise().variance(linear / gain.max(1e-6));
        let noisy = linear + normal * (wanted - left).max(0.0).sqrt();
        (255.0 * self.other.encode(self.other.respond(noisy))).round().clamp(0.0, 255.0) as u8
    }
}

/// Returns the light between pixels, by bilinear interpolation; beyond the picture's sides it continues as at the sides.
fn interpolated(light: &Light, place: DVec2) -> Vec3 {
    let (floor, part) = (place.floor(), place.fract_gl().as_vec2());
    let row = |v: isize| {
        let row = light.nearest_row(v);
        let at = |u: isize| row[u.clamp(0, row.len() as isize - 1) as usize];
        at(floor.x as isize).lerp(at(floor.x as isize + 1), part.x)
    };
    row(floor.y as isize).lerp(row(floor.y as isize + 1), part.y)
}

/// Returns the part of white noise's variance that a blur of this variance along both axes keeps: `(e^{-2t} I₀(2t))²` for the
/// kernel of diffusing heat (Lindeberg 1990), by the integral of the Bessel function.
fn kept_by_blur(variance_px2: f64) -> f64 {
    const STEPS: u32 = 24;
    if variance_px2 <= 0.0 {
        return 1.0;
    }
    let angle = |step: u32| std::f64::consts::PI * (f64::from(step) + 0.5) / f64::from(STEPS);
    let terms = (0..STEPS).map(|step| (2.0 * variance_px2 * (angle(step).cos() - 1.0)).exp());
    (terms.sum::<f64>() / f64::from(STEPS)).powi(2)
}

#[cfg(test)]
mod tests {
    use reality_sim_core::{
        camera::{Camera, Distortion},
        field::FieldDimensions,
        pose::{CameraPose, Pose2},
        sequence::{CameraSetup, Photometry},
    };

    use super::*;
    use crate::{Model, effect};

    fn setup() -> CameraSetup {
        let camera = Camera::new([64, 48], [50.0, 50.0, 31.5, 23.5], Distortion::Pinhole).unwrap();
        let photometry = Photometry {
            noise_shot: Some(0.001),
            noise_read: Some(0.004),
            psf_sigma_px: Some(0.5),
            ..Photometry::of_gamma(2.2)
        };
        CameraSetup { camera, mount_height_m: 0.5, photometry: Some(photometry) }
    }

    fn chain(model: &Model) -> Chain {
        Chain::new(&setup(), &FieldDimensions::preset("humanoid-kidsize-2010").unwrap(), model).unwrap()
    }

    fn with(id: &str, value: f64) -> Model {
        Model::default().with(effect(id).unwrap(), vec![value])
    }

    fn redeveloped(picture: &RgbImage, model: &Model) -> RgbImage {
        let [recorded, other] = [&Model::default(), model].map(chain);
        let pose = CameraPose::new(Pose2::default(), 0.5, 0.4, 0.0);
        Redevelopment { recorded: &recorded, other: &other }.picture(picture, pose, 1.0, 7)
    }

    fn gradient() -> RgbImage {
        RgbImage::from_fn(64, 48, |x, y| Rgb([40 + 2 * x as u8, 90 + y as u8, 120]))
    }

    #[test]
    fn the_same_camera_records_the_same_picture() {
        assert_eq!(redeveloped(&gradient(), &Model::default()), gradient());
        let chain = chain(&Model::default());
        assert!(!Redevelopment { recorded: &chain, other: &chain }.changes(&[0.0, 1.0]));
    }

    #[test]
    fn each_photometric_effect_changes_pictures_and_an_effect_of_the_files_does_not() {
        let nominal = chain(&Model::default());
        let changes = |id: &str, value: f64| {
            Redevelopment { recorded: &nominal, other: &chain(&with(id, value)) }.changes(&[0.0, 1.0])
        };
        let photometric = [
            ("vignetting", 0.3),
            ("tone_curve", 0.1),
            ("black_level", 0.05),
            ("defocus", 1.0),
            ("sensor_noise", 0.01),
        ];
        for (id, value) in photometric {
            assert!(changes(id, value), "{id}");
        }
        assert!(!changes("mount_pitch", 0.02));
    }

    #[test]
    fn a_falloff_darkens_the_corners_as_much_as_the_model_says_and_not_the_middle() {
        let grey = RgbImage::from_pixel(64, 48, Rgb([150; 3]));
        let dark = redeveloped(&grey, &with("vignetting", 0.4));
        let light = |pixel: &Rgb<u8>| (f64::from(pixel.0[1]) / 255.0).powf(2.2);
        let mean = |picture: &RgbImage, at: [u32; 2]| -> f64 {
            let around = (0..6).flat_map(|x| (0..6).map(move |y| [at[0] + x, at[1] + y]));
            around.map(|[x, y]| light(picture.get_pixel(x, y))).sum::<f64>() / 36.0
        };
        let kept = |at: [u32; 2]| mean(&dark, at) / mean(&grey, at);
        assert!((kept([29, 21]) - 1.0).abs() < 0.02, "{}", kept([29, 21]));
        let corner = chain(&with("vignetting", 0.4)).falloff(DVec2::new(2.5, 2.5));
        assert!((kept([0, 0]) - corner).abs() < 0.03, "{} {corner}", kept([0, 0]));
    }

    #[test]
    fn a_blur_keeps_the_share_of_noise_that_its_kernel_has() {
        for variance_px2 in [0.1, 0.5, 2.0] {
            let mut light = Light::dark([65, 65]);
            light.rows_mut().enumerate().filter(|(v, _)| *v == 32).for_each(|(_, row)| row[32] = Vec3::ONE);
            let blurred = blurred(light, |_| variance_px2);
            let energy: f64 = (0..65)
                .flat_map(|v| blurred.nearest_row(v).to_vec())
                .map(|light| f64::from(light.x).powi(2))
                .sum();
            let kept = kept_by_blur(variance_px2);
            assert!((energy / kept - 1.0).abs() < 0.05, "{variance_px2}: {energy} {kept}");
        }
    }
}
