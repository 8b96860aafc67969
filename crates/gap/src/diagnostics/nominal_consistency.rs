//! Nominal values that would have to be farther off than they are trusted: no effect explains it, tolerances do not, either.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{
    diagnostics::residual_patterns::LIKELY_CHANCE, inference::model_error::ModelError,
    linear_model::nuisance::Nuisance, measurement::quantity::Channel, report::data::Unexplained,
};

/// Channels whose nominal values are in the camera's file.
const CHANNELS: [Channel; 3] = [Channel::Photometry, Channel::Sharpness, Channel::Noise];

/// What a fit makes of the tolerances, in their standard deviations: too much of all of a channel together is told, with
/// the one that is farthest off.
pub(crate) fn strained(tolerances: &[Nuisance], fitted: &[f64], explained: &ModelError) -> Vec<Unexplained> {
    let told = |channel| of_channel(channel, tolerances, fitted, explained.most_off(channel));
    CHANNELS.into_iter().filter_map(told).collect()
}

/// `off` is by how much more the channel's numbers may be off.
fn of_channel(channel: Channel, tolerances: &[Nuisance], fitted: &[f64], off: f64) -> Option<Unexplained> {
    let nominal: Vec<(Nominal, f64)> = tolerances
        .iter()
        .zip(fitted)
        .filter_map(|(tolerance, value)| {
            Some((Nominal::of(tolerance).filter(|nominal| nominal.channel == channel)?, *value))
        })
        .collect();
    let strain = |(nominal, value): &(Nominal, f64)| value * nominal.sigma / nominal.allowed(off);
    let squares: f64 = nominal.iter().map(|nominal| strain(nominal).powi(2)).sum();
    let p_value = ChiSquared::new(nominal.len().max(1) as f64).ok()?.sf(squares);
    let (farthest, value) = nominal.into_iter().max_by(|a, b| strain(a).abs().total_cmp(&strain(b).abs()))?;
    (p_value < LIKELY_CHANCE).then(|| Unexplained {
        channel: channel.name().to_owned(),
        r#where: format!(
            "in all pictures, most of all {}: farther from what camera.toml says than that is trusted",
            farthest.name
        ),
        size: farthest.off_by(value),
        unit: farthest.unit.to_owned(),
        p_value: Some(p_value),
    })
}

/// A nominal value of the camera's file.
struct Nominal {
    channel: Channel,
    name: &'static str,
    /// How far it is trusted.
    sigma: f64,
    unit: &'static str,
    /// Whether it is an offset of the channel's numbers.
    is_of_rows: bool,
}

impl Nominal {
    /// How far it may be off: beside what it is trusted, where it is an offset of the channel's numbers, by what those may be.
    fn allowed(&self, off: f64) -> f64 {
        if self.is_of_rows { self.sigma.hypot(off) } else { self.sigma }
    }

    /// The part that it is off by where it is compared by its logarithm; else the difference. In standard deviations.
    fn off_by(&self, value: f64) -> f64 {
        let difference = value * self.sigma;
        if self.channel == Channel::Sharpness { difference.abs() } else { difference.exp_m1().abs() }
    }

    /// What a tolerance is of; patches of carpet are in no file.
    fn of(tolerance: &Nuisance) -> Option<Self> {
        let is_of_rows = matches!(tolerance, Nuisance::Offset { .. } | Nuisance::Width { .. });
        let (channel, name, sigma, unit) = match *tolerance {
            Nuisance::Offset { quantity, sigma } => {
                (quantity.channel(), quantity.name(), sigma, quantity.unit())
            }
            Nuisance::Sheen { sigma, .. } => {
                (Channel::Photometry, "carpet seen at a grazing angle", sigma, "1")
            }
            Nuisance::Width { sigma } => {
                (Channel::Sharpness, "the blur of broad lines against thin ones", sigma, "px2")
            }
            Nuisance::Kernel { sigma } | Nuisance::ThinKernel { sigma } => {
                (Channel::Sharpness, "the shape of the blur", sigma, "1")
            }
            Nuisance::Patch { .. } => return None,
        };
        Some(Self { channel, name, sigma, unit, is_of_rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        linear_model::nuisance::tolerances,
        measurement::quantity::{ColorChannel, Quantity},
    };

    /// What is told where the tolerances that are picked are so many standard deviations off, the others half a one.
    fn told(value: f64, explained: &ModelError, picked: impl Fn(&Nominal) -> bool) -> Vec<Unexplained> {
        let tolerances = tolerances(&[]);
        let off = |tolerance| if Nominal::of(tolerance).is_some_and(|n| picked(&n)) { value } else { 0.5 };
        strained(&tolerances, &tolerances.iter().map(off).collect::<Vec<_>>(), explained)
    }

    #[test]
    fn what_is_within_its_tolerance_is_not_told_and_what_is_far_beyond_is_named() {
        assert_eq!(told(0.5, &ModelError::default(), |_| true), []);
        let [told] = &told(5.0, &ModelError::default(), |nominal| nominal.name == "red of carpet")[..] else {
            panic!()
        };
        assert!(told.r#where.contains("red of carpet"), "{}", told.r#where);
        assert!((told.size - 0.35_f64.exp_m1()).abs() < 1e-9 && told.p_value.unwrap() < LIKELY_CHANCE);
    }

    #[test]
    fn what_a_model_explains_its_values_may_be_off_by_a_part_of() {
        let explained = ModelError::by(Quantity::LineLevel(ColorChannel::Blue), 2.0);
        assert_eq!(told(5.0, &explained, |nominal| nominal.name == "blue of lines"), []);
        assert_eq!(told(5.0, &explained, |nominal| nominal.channel == Channel::Noise).len(), 1);
    }

    #[test]
    fn every_channel_is_judged_by_itself() {
        for channel in CHANNELS {
            let told = told(6.0, &ModelError::default(), |nominal| nominal.channel == channel);
            assert_eq!(told.len(), 1, "{told:?}");
            assert_eq!(told[0].channel, channel.name());
        }
    }
}
