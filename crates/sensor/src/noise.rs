//! Noise of the sensor.

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
