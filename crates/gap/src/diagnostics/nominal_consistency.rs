//! Nominal values of the camera's file that would have to be farther off than they are trusted: no effect explains what is
//! left, and the nuisance parameters do not, either.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{
    diagnostics::detector::{Detector, FitResiduals, SIGNIFICANCE},
    diagnostics::finding::{Finding, NominalValue},
    inference::model_error::ModelError,
    linear_model::nuisance::Nuisance,
    measurement::quantity::{Channel, Quantity},
};

/// Channels whose nominal values are in the camera's file.
const CHANNELS: [Channel; 3] = [Channel::Photometry, Channel::Sharpness, Channel::Noise];

/// Finds channels whose nominal values are inconsistent with the recording.
pub(crate) struct NominalConsistency;

impl Detector for NominalConsistency {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        inconsistent(fit.nuisances, fit.nuisance_values, fit.model_error)
    }
}

/// `fitted` are values of the nuisance parameters in their standard deviations. Too much of all of a channel together is
/// told, with the one that is farthest off.
fn inconsistent(nuisances: &[Nuisance], fitted: &[f64], model_error: &ModelError) -> Vec<Finding> {
    let of = |channel| of_channel(channel, nuisances, fitted, model_error.most_off(channel));
    CHANNELS.into_iter().filter_map(of).collect()
}

/// `off` is by how much more the channel's residuals may be off.
fn of_channel(channel: Channel, nuisances: &[Nuisance], fitted: &[f64], off: f64) -> Option<Finding> {
    let nominal: Vec<(Nominal, f64)> = nuisances
        .iter()
        .zip(fitted)
        .filter_map(|(nuisance, fitted)| {
            Some((Nominal::of(nuisance).filter(|nominal| nominal.value.channel() == channel)?, *fitted))
        })
        .collect();
    let normalized = |(nominal, fitted): &(Nominal, f64)| fitted * nominal.sigma / nominal.allowed(off);
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

/// A nominal value with its standard deviation.
struct Nominal {
    value: NominalValue,
    /// Standard deviation: how far it is trusted.
    sigma: f64,
    /// Whether it is an offset of the channel's residuals.
    is_offset: bool,
}

impl Nominal {
    /// How far it may be off: beside what it is trusted, where it is an offset of the residuals, by what those may be.
    fn allowed(&self, off: f64) -> f64 {
        if self.is_offset { self.sigma.hypot(off) } else { self.sigma }
    }

    /// The part that it is off by where it is compared by its logarithm; else the difference. `fitted` is in standard
    /// deviations.
    fn off_by(&self, fitted: f64) -> f64 {
        let difference = fitted * self.sigma;
        if self.value.channel() == Channel::Sharpness { difference.abs() } else { difference.exp_m1().abs() }
    }

    /// The nominal value that a nuisance parameter is of; patches of carpet are in no file.
    fn of(nuisance: &Nuisance) -> Option<Self> {
        let is_offset = matches!(nuisance, Nuisance::Offset { .. } | Nuisance::Width { .. });
        let (value, sigma) = match *nuisance {
            Nuisance::Offset { quantity, sigma } => (offset_of(quantity)?, sigma),
            Nuisance::Sheen { sigma, .. } => (NominalValue::Sheen, sigma),
            Nuisance::Width { sigma } => (NominalValue::BlurByWidth, sigma),
            Nuisance::Kernel { sigma } | Nuisance::ThinKernel { sigma } => (NominalValue::BlurShape, sigma),
            Nuisance::Patch { .. } => return None,
        };
        Some(Self { value, sigma, is_offset })
    }
}

fn offset_of(quantity: Quantity) -> Option<NominalValue> {
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
    use super::*;
    use crate::{linear_model::nuisance::nuisances, measurement::quantity::ColorChannel};

    /// What is told where the nuisances that are picked are so many standard deviations off, the others half a one.
    fn told(value: f64, explained: &ModelError, picked: impl Fn(&Nominal) -> bool) -> Vec<Finding> {
        let nuisances = nuisances(&[]);
        let off = |nuisance| if Nominal::of(nuisance).is_some_and(|n| picked(&n)) { value } else { 0.5 };
        inconsistent(&nuisances, &nuisances.iter().map(off).collect::<Vec<_>>(), explained)
    }

    #[test]
    fn what_is_within_its_tolerance_is_not_told_and_what_is_far_beyond_is_named() {
        assert_eq!(told(0.5, &ModelError::default(), |_| true), []);
        let red = NominalValue::CarpetLevel(ColorChannel::Red);
        let [Finding::NominalValue { value, off_by, p_value }] =
            told(5.0, &ModelError::default(), |nominal| nominal.value == red)[..]
        else {
            panic!()
        };
        assert_eq!(value, red);
        assert!((off_by - 0.35_f64.exp_m1()).abs() < 1e-9 && p_value < SIGNIFICANCE);
    }

    #[test]
    fn what_a_model_explains_its_values_may_be_off_by_a_part_of() {
        let explained = ModelError::by(Quantity::LineLevel(ColorChannel::Blue), 2.0);
        assert_eq!(
            told(5.0, &explained, |nominal| nominal.value == NominalValue::LineLevel(ColorChannel::Blue)),
            []
        );
        assert_eq!(told(5.0, &explained, |nominal| nominal.value.channel() == Channel::Noise).len(), 1);
    }

    #[test]
    fn every_channel_is_judged_by_itself() {
        for channel in CHANNELS {
            let told = told(6.0, &ModelError::default(), |nominal| nominal.value.channel() == channel);
            assert_eq!(told.len(), 1, "{told:?}");
            assert_eq!(told[0].channel(), channel);
        }
    }
}
