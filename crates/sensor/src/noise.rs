//! Noise of the sensor.

use reality_sim_core::filter::{Purpose, Stream};

/// Poisson–Gaussian noise of a linear value `v`: its variance is `shot · v + read_variance` (Foi et al., "Practical
/// Poissonian-Gaussian noise modeling and fitting for single-image raw-data", TIP 2008).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Variance of the shot noise per unit of the linear value.
    pub shot: f64,
    /// Variance of the read noise, present without light.
    pub read_variance: f64,
}

impl Noise {
    /// Returns the noise variance of a linear value; values below 0 have read noise only.
    pub fn variance(self, linear: f64) -> f64 {
        self.shot * linear.max(0.0) + self.read_variance
    }
}

/// Returns the random numbers of the noise of the picture with this timestamp, seconds: pictures at different times have different
/// noise. `kind` tells uses of one picture apart.
pub(crate) fn noise_stream(seed: u64, time_s: f64, kind: u32) -> Stream {
    let bits = time_s.to_bits();
    Stream::new(seed, Purpose::Picture, (bits ^ (bits >> 32)) as u32, kind)
}
