//! Conversion from light to the sensor's linear output.

use glam::Vec3;
use reality_sim_core::filter::Stream;

use crate::{Chain, noise::noise_stream};

/// Sensor while one picture is taken.
#[derive(Debug)]
pub(crate) struct Sensor<'a> {
    chain: &'a Chain,
    gain: Vec3,
    /// Random stream of the noise; `None` for a picture without noise.
    noise: Option<Stream>,
}

impl<'a> Sensor<'a> {
    /// Prepares one picture; pictures of the same seed and different times have different noise.
    pub(crate) fn new(chain: &'a Chain, time_s: f64, noise_seed: Option<u64>) -> Self {
        let gain = Vec3::from_array(chain.gain(time_s).map(|gain| gain as f32));
        let noise = noise_seed.map(|seed| noise_stream(seed, time_s, 0));
        Self { chain, gain, noise }
    }

    /// Returns the output of a pixel, indexed row by row. The noise covers the light and its readout; what the sensor's
    /// response adds afterwards has none.
    pub(crate) fn record(&self, light: Vec3, pixel: u32) -> Vec3 {
        let exposed = light * self.gain;
        let noisy = self.noise.map_or(exposed, |stream| exposed + self.noise(exposed, stream, pixel));
        Vec3::from_array(noisy.to_array().map(|v| self.chain.respond(f64::from(v)) as f32))
    }

    fn noise(&self, exposed: Vec3, stream: Stream, pixel: u32) -> Vec3 {
        let [red, green, blue, ..] = stream.normals(pixel).map(|normal| normal as f32);
        let variance = exposed.to_array().map(|v| self.chain.noise().variance(f64::from(v)) as f32);
        Vec3::new(red, green, blue) * Vec3::from_array(variance.map(f32::sqrt))
    }
}
