//! The sensor's noise.

/// Poisson–Gaussian noise of a linear value `v`: its variance is `shot · v + read_variance` (Foi et al., "Practical
/// Poissonian-Gaussian noise modeling and fitting for single-image raw-data", TIP 2008).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Variance of the shot noise for each unit of the linear value.
    pub shot: f64,
    /// Variance without light, of the read noise.
    pub read_variance: f64,
}

impl Noise {
    /// Variance of a linear value's noise; light below 0 counts as none.
    pub fn variance(self, linear: f64) -> f64 {
        self.shot * linear.max(0.0) + self.read_variance
    }
}
