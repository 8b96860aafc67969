//! Sensor noise: the sensor is noisier or quieter than its data sheet says.
//!
//! The values are added to `noise_shot` and to the square of `noise_read`, the two terms of Poisson–Gaussian noise
//! ([`Noise`]); negative sums are set to 0.

use crate::{
    effect::{About, Changes, Covariate, Effect, Estimates, Need, Opposite, Parameter, Stage, values},
    noise::Noise,
    text::{Amount, Uncertain, Unit},
};

#[derive(Debug)]
pub(super) struct SensorNoise;

const ABOUT: About = About {
    id: "sensor_noise",
    name: "the sensor's noise is not as written down",
    because: "pixel values scatter more than they should around their mean, in dark and bright places",
    opposite: Some(Opposite {
        name: "the sensor is quieter than written down",
        because: "pixel values scatter less than they should around their mean, in dark and bright places",
    }),
    noun: "another noise",
    rank: 190,
    unit: Unit::Plain,
    stage: Stage::Sensor,
    parameters: &[
        Parameter { step: 7.5e-5, ..Parameter::size("shot", "1", [-0.01, 0.05], 3e-4) },
        Parameter { step: 1e-6, ..Parameter::size("read_variance", "1", [-1e-4, 1e-2], 4e-6) },
    ],
    covariates: &[Covariate::Intensity],
    needs: &[Need::NominalNoise],
    changes: Changes::Noise,
    varies_over_time: false,
    recording_that_would_decide: "stand still and look at plain carpet and broad lines, without compression",
};

impl Effect for SensorNoise {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn size(&self, estimates: &Estimates<'_>) -> Option<String> {
        let (tenths, variance) = best_known_variance(estimates)?;
        let place = match tenths {
            0 => "where it is black".to_owned(),
            10 => "where it is white".to_owned(),
            _ => format!("at {} % of full light", 10 * tenths),
        };
        let size = variance.value.abs().sqrt();
        let number = Uncertain { value: 100.0 * size, sigma: 100.0 * variance.sigma / (2.0 * size) };
        let noise = Amount { number, unit: Unit::PercentOfFullScale };
        let word = if variance.value < 0.0 { "is too much" } else { "is missing" };
        Some(format!("{place}, {} {word}{}", noise.signed(), noise.interval()))
    }

    fn noise(&self, p: &[f64], noise: Noise) -> Noise {
        let [shot, read_variance] = values(p);
        Noise {
            shot: (noise.shot + shot).max(0.0),
            read_variance: (noise.read_variance + read_variance).max(0.0),
        }
    }
}

/// Returns the light, in tenths of full scale, at which the change of the noise variance is known best, and that change.
/// Shot noise and read noise may be hard to separate while their sum is well known.
fn best_known_variance(estimates: &Estimates<'_>) -> Option<(i32, Uncertain)> {
    let (shot, read) = (estimates.get("shot")?, estimates.get("read_variance")?);
    let correlation = estimates.correlation("shot", "read_variance");
    let at = |tenths: i32| {
        let light = f64::from(tenths) / 10.0;
        let (of_light, both) = (light * shot.sigma, 2.0 * correlation * light * shot.sigma * read.sigma);
        let variance = (of_light.powi(2) + read.sigma.powi(2) + both).max(0.0);
        (tenths, Uncertain { value: light * shot.value + read.value, sigma: variance.sqrt() })
    };
    let sigmas = |change: &Uncertain| change.value.abs() / change.sigma.max(f64::MIN_POSITIVE);
    (0..=10).map(at).max_by(|a, b| sigmas(&a.1).total_cmp(&sigmas(&b.1)))
}
