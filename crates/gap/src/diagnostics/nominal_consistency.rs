//! Consistency of the camera file's nominal values with the recording. The nuisance parameters absorb errors of nominal
//! values within their tolerances; if a fit needs much more, something that no effect explains is at work.
//!
//! The fitted values of a channel's nuisance parameters, in their standard deviations, are tested by a χ² test.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{
    diagnostics::detector::{Detector, FitResiduals, SIGNIFICANCE},
    diagnostics::finding::{Finding, NominalValue},
    inference::model_error::ModelError,
    linear_model::nuisance::Nuisance,
    measurement::quantity::{Channel, Quantity},
    thresholds::{NuisanceThresholds, Thresholds},
};

const NUISANCES: NuisanceThresholds = Thresholds::DEFAULT.linear_model.nuisance;
/// Channels whose nominal values are in the camera file.
const CHANNELS: [Channel; 3] = [Channel::Photometry, Channel::Sharpness, Channel::Noise];

/// Detector of channels whose nominal values are inconsistent with the recording.
pub(crate) struct NominalConsistency;

impl Detector for NominalConsistency {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        inconsistent(fit.nuisances, fit.nuisance_values, fit.model_error)
    }
}

/// Returns the nominal value that is farthest off for each inconsistent channel. `fitted` are the values of the nuisance
/// parameters in their standard deviations.
fn inconsistent(nuisances: &[Nuisance], fitted: &[f64], model_error: &ModelError) -> Vec<Finding> {
    let of = |channel| of_channel(channel, nuisances, fitted, model_error.most_off(channel));
    CHANNELS.into_iter().filter_map(of).collect()
}

/// Tests the nominal values of a channel. `model_error` is the error that the channel's residuals may have besides.
fn of_channel(channel: Channel, nuisances: &[Nuisance], fitted: &[f64], model_error: f64) -> Option<Finding> {
    let nominal: Vec<(Nominal, f64)> = nuisances
        .iter()
        .zip(fitted)
        .filter_map(|(nuisance, fitted)| {
            Some((Nominal::of(nuisance).filter(|nominal| nominal.value.channel() == channel)?, *fitted))
        })
        .collect();
    let normalized =
        |(nominal, fitted): &(Nominal, f64)| fitted * nominal.sigma / nominal.total_sigma(model_error);
    let squares: f64 = nominal.iter().map(|nominal| normalized(nominal).powi(2)).sum();
    let p_value = ChiSquared::new(nominal.len().max(1) as f64).ok()?.sf(squares);
    let (farthest, fitted) =
        nominal.into_iter().max_by(|a, b| normalized(a).abs().total_cmp(&normalized(b).abs()))?;
    (p_value < SIGNIFICANCE).then(|| Finding::NominalValue {
        value: farthest.value,
        off_by: farthest.off_by(fitted),
        p_value,
    })
}

/// Nominal value with its standard deviation.
struct Nominal {
    value: NominalValue,
    /// Standard deviation of the prior: its tolerance.
    sigma: f64,
    /// Whether an error of the value shifts residuals of the channel by a constant.
    is_offset: bool,
}

impl Nominal {
    /// Returns the standard deviation of the value's error. For an offset of the residuals it includes the model error.
    fn total_sigma(&self, model_error: f64) -> f64 {
        if self.is_offset { self.sigma.hypot(model_error) } else { self.sigma }
    }

    /// Returns by how much the value is off: as a fraction if it is compared by its logarithm, otherwise as a difference.
    /// `fitted` is in standard deviations.
    fn off_by(&self, fitted: f64) -> f64 {
        let difference = fitted * self.sigma;
        if self.value.channel() == Channel::Sharpness { difference.abs() } else { difference.exp_m1().abs() }
    }

    /// Returns the nominal value that a nuisance parameter belongs to. None for what is in no file.
    fn of(nuisance: &Nuisance) -> Option<Self> {
        let is_offset = matches!(nuisance, Nuisance::Offset { .. } | Nuisance::Width { .. });
        let (value, sigma) = match *nuisance {
            Nuisance::Offset { quantity, sigma } => (offset_of(quantity, sigma)?, sigma),
            Nuisance::Width { sigma } => (NominalValue::BlurByWidth, sigma),
            Nuisance::Kernel { sigma } | Nuisance::ThinKernel { sigma } => (NominalValue::BlurShape, sigma),
            Nuisance::Gain { .. }
            | Nuisance::ThinLine { .. }
            | Nuisance::Sheen { .. }
            | Nuisance::Pile { .. }
            | Nuisance::NoiseExponent { .. }
            | Nuisance::OdometryClock { .. }
            | Nuisance::AttitudeClock { .. }
            | Nuisance::Texture { .. } => return None,
        };
        Some(Self { value, sigma, is_offset })
    }
}

/// Returns the nominal value of a quantity. None where none is given, so that it is free.
fn offset_of(quantity: Quantity, sigma: f64) -> Option<NominalValue> {
    if quantity.is_level() && sigma >= NUISANCES.free_level
        || quantity == Quantity::LineBlur && sigma >= NUISANCES.free_blur_px2
    {
        return None;
    }
    match quantity {
        Quantity::LineLevel(color) => Some(NominalValue::LineLevel(color)),
        Quantity::CarpetLevel(color) => Some(NominalValue::CarpetLevel(color)),
        Quantity::LineBlur => Some(NominalValue::Blur),
        Quantity::NoiseVariance => Some(NominalValue::NoiseVariance),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use reality_sim_core::sequence::Photometry;

    use super::*;
    use crate::{
        linear_model::{
            mean_reflectance::{MeanReflectance, SurfaceReflectance},
            nuisance::nuisances,
            texture::CarpetTexture,
        },
        measurement::quantity::ColorChannel,
    };

    /// Returns the findings if the picked nominal values are `value` standard deviations off and the others half a standard
    /// deviation.
    fn findings(value: f64, model_error: &ModelError, picked: impl Fn(&Nominal) -> bool) -> Vec<Finding> {
        let surface = SurfaceReflectance { linear_rgb: [0.5; 3], sigma: 0.05, color_sigma: 0.02 };
        let mean = MeanReflectance { line: surface, carpet: surface };
        let given = Photometry { psf_sigma_px: Some(0.5), ..Photometry::of_gamma(2.2) };
        let nuisances = nuisances(&mean, &CarpetTexture::default(), &given);
        let off = |nuisance| if Nominal::of(nuisance).is_some_and(|n| picked(&n)) { value } else { 0.5 };
        inconsistent(&nuisances, &nuisances.iter().map(off).collect::<Vec<_>>(), model_error)
    }

    #[test]
    fn a_nominal_value_within_its_tolerance_is_not_reported_and_one_far_beyond_is() {
        assert_eq!(findings(0.5, &ModelError::default(), |_| true), []);
        let red = NominalValue::CarpetLevel(ColorChannel::Red);
        let [Finding::NominalValue { value, off_by, p_value }] =
            findings(5.0, &ModelError::default(), |nominal| nominal.value == red)[..]
        else {
            panic!()
        };
        assert_eq!(value, red);
        assert!((off_by - (5.0_f64 * 0.02).exp_m1()).abs() < 1e-9 && p_value < SIGNIFICANCE);
    }

    #[test]
    fn nominal_values_may_be_off_by_the_model_error_of_their_channel() {
        let explained = ModelError::by(Quantity::LineLevel(ColorChannel::Blue), 2.0);
        assert_eq!(
            findings(5.0, &explained, |nominal| nominal.value == NominalValue::LineLevel(ColorChannel::Blue)),
            []
        );
        assert_eq!(findings(5.0, &explained, |nominal| nominal.value.channel() == Channel::Noise).len(), 1);
    }

    #[test]
    fn each_channel_is_tested_by_itself() {
        for channel in CHANNELS {
            let found = findings(6.0, &ModelError::default(), |nominal| nominal.value.channel() == channel);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].channel(), channel);
        }
    }
}
