//! The sensor is noisier or quieter than its data sheet says.
//!
//! What is added to `noise_shot` and to the square of `noise_read`; what falls below 0 is 0.

use crate::effect::{About, Covariate, Effect, Noise, Parameter, Stage, values};

#[derive(Debug)]
pub(super) struct SensorNoise;

const ABOUT: About = About {
    id: "sensor_noise",
    name: "the sensor's noise is not as written down",
    stage: Stage::Sensor,
    parameters: &[
        Parameter::size("shot", "1", [-0.01, 0.05], 1.5e-4),
        Parameter::size("read_variance", "1", [-1e-4, 1e-2], 2e-6),
    ],
    covariates: &[Covariate::Intensity],
    because: "pixel values scatter more than they should around their mean, in dark and bright places",
    recording_that_would_decide: "stand still and look at plain carpet and broad lines, without compression",
};

impl Effect for SensorNoise {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn noise(&self, p: &[f64], noise: Noise) -> Noise {
        let [shot, read_variance] = values(p);
        Noise {
            shot: (noise.shot + shot).max(0.0),
            read_variance: (noise.read_variance + read_variance).max(0.0),
        }
    }
}
