//! The light that a lens loses towards the corners and that the exposure changes over time, taken out of pictures and put into
//! them.

use glam::DVec2;

use crate::chain::Chain;

/// Number of linear values, evenly spaced from 0 to full scale in encoded terms, that are encoded in advance.
const LEVELS: usize = 4096;
/// Least share of the light that is divided out: less is noise.
const LEAST_SHARE: f32 = 0.05;

/// What a camera does to the light of whole pictures: its lens's falloff and its gain over time, before black level and tone
/// curve.
#[derive(Debug, Clone)]
pub struct Shading {
    chain: Chain,
    size: [u32; 2],
    /// Share of the light that reaches each pixel, row by row.
    falloff: Vec<f32>,
    /// Linear values of the 256 encoded ones.
    linear: Vec<f32>,
    /// Encoded values of linear ones, whose square roots are evenly spaced.
    encoded: Vec<u8>,
}

impl Shading {
    /// Makes the shading of a simulated camera; `None` where it changes no light.
    pub fn new(chain: &Chain) -> Option<Self> {
        let camera = chain.camera();
        let size = [camera.width, camera.height];
        let pixels = (0..size[1]).flat_map(|v| (0..size[0]).map(move |u| DVec2::new(u.into(), v.into())));
        let falloff: Vec<f32> = pixels.map(|pixel| chain.falloff(pixel) as f32).collect();
        if !chain.changes_gain() && falloff.iter().all(|share| *share == 1.0) {
            return None;
        }
        let encode = |linear: f64| chain.encode(chain.respond(linear));
        let values = (0..LEVELS).map(|level| (level as f64 / (LEVELS - 1) as f64).powi(2));
        let encoded: Vec<f64> = values.clone().map(encode).collect();
        let linear = (0..=255_u8).map(|value| {
            let reached = encoded.partition_point(|level| 255.0 * level < f64::from(value));
            (reached.min(LEVELS - 1) as f32 / (LEVELS - 1) as f32).powi(2)
        });
        let linear = linear.collect();
        let encoded = encoded.iter().map(|value| (255.0 * value).round() as u8).collect();
        Some(Self { chain: chain.clone(), size, falloff, linear, encoded })
    }

    /// Returns width and height of the camera's pictures, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Takes falloff and gain out of the picture of the frame with this timestamp: RGB, row by row.
    ///
    /// # Panics
    ///
    /// If the picture does not have the camera's size.
    pub fn take_out(&self, colors: &mut [[u8; 3]], time_s: f64) {
        let gain = self.chain.gain(time_s).map(|gain| gain as f32);
        self.scale(colors, |falloff, channel| 1.0 / (falloff * gain[channel]).max(LEAST_SHARE));
    }

    /// Puts the lens's falloff into a picture that has none: RGB, row by row.
    ///
    /// # Panics
    ///
    /// If the picture does not have the camera's size.
    pub fn put_in(&self, colors: &mut [[u8; 3]]) {
        self.scale(colors, |falloff, _| falloff);
    }

    fn scale(&self, colors: &mut [[u8; 3]], factor: impl Fn(f32, usize) -> f32) {
        assert_eq!(colors.len(), self.falloff.len(), "pictures have the camera's size");
        for (color, &falloff) in colors.iter_mut().zip(&self.falloff) {
            for (channel, value) in color.iter_mut().enumerate() {
                let linear = self.linear[usize::from(*value)] * factor(falloff, channel);
                let level = linear.clamp(0.0, 1.0).sqrt() * (LEVELS - 1) as f32;
                *value = self.encoded[level.round() as usize];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use reality_sim_core::{
        camera::{Camera, Distortion},
        field::FieldDimensions,
        sequence::{CameraSetup, Photometry},
    };

    use super::*;
    use crate::{Model, effect};

    fn chain(model: &Model) -> Chain {
        let camera = Camera::new([64, 48], [40.0, 40.0, 31.5, 23.5], Distortion::Pinhole).unwrap();
        let photometry = Photometry { black_level: Some(0.02), ..Photometry::of_gamma(2.2) };
        let setup = CameraSetup { camera, mount_height_m: 0.5, photometry: Some(photometry) };
        Chain::new(&setup, &FieldDimensions::preset("spl").unwrap(), model).unwrap()
    }

    #[test]
    fn what_is_taken_out_is_what_was_put_in() {
        let model = Model::default().with(effect("vignetting").unwrap(), [0.6, 0.1]);
        let shading = Shading::new(&chain(&model)).unwrap();
        let plain: Vec<[u8; 3]> = (0..64 * 48).map(|i| [90, 120 + (i % 60) as u8, 200]).collect();
        let mut colors = plain.clone();
        shading.put_in(&mut colors);
        assert!(colors[0][2] < 150 && colors[64 * 24 + 32][2].abs_diff(200) <= 1, "{:?}", colors[0]);
        shading.take_out(&mut colors, 0.0);
        for (color, plain) in colors.iter().zip(&plain) {
            for channel in 0..3 {
                assert!(color[channel].abs_diff(plain[channel]) <= 2, "{color:?} for {plain:?}");
            }
        }
    }

    #[test]
    fn a_gain_is_taken_out_channel_by_channel() {
        let model = Model::default().with(effect("white_balance").unwrap(), [0.3, -0.2]);
        let chain = chain(&model);
        let shading = Shading::new(&chain).unwrap();
        let gain = chain.gain(1.0);
        let seen: [u8; 3] = std::array::from_fn(|channel| {
            (255.0 * chain.encode(chain.respond(0.3 * gain[channel]))).round() as u8
        });
        let mut colors = vec![seen; 64 * 48];
        shading.take_out(&mut colors, 1.0);
        let wanted = (255.0 * chain.encode(chain.respond(0.3))).round() as u8;
        assert!(colors[5].iter().all(|value| value.abs_diff(wanted) <= 1), "{:?} for {wanted}", colors[5]);
    }

    #[test]
    fn a_camera_that_changes_no_light_has_no_shading() {
        let model = Model::default().with(effect("focal_length").unwrap(), [0.01]);
        assert!(Shading::new(&chain(&model)).is_none());
    }
}
