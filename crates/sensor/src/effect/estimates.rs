//! Estimates of an effect's parameters from a fit.

use std::fmt;

use crate::text::{Uncertain, with_sigma};

/// Estimates of an effect's parameters, by name, with the correlation of their errors.
#[derive(Clone, Copy)]
pub struct Estimates<'a> {
    values: &'a [(&'static str, Uncertain)],
    correlation: &'a dyn Fn(&str, &str) -> f64,
}

impl fmt::Debug for Estimates<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Estimates").field("values", &self.values).finish_non_exhaustive()
    }
}

impl<'a> Estimates<'a> {
    /// Takes estimates in the order of the effect's parameters, some of which may be missing. `correlation` returns the
    /// correlation of the errors of two parameters, −1 to 1.
    pub fn new(values: &'a [(&'static str, Uncertain)], correlation: &'a dyn Fn(&str, &str) -> f64) -> Self {
        Self { values, correlation }
    }

    /// Returns the estimate of a parameter; `None` where it is missing or not finite.
    pub fn get(&self, name: &str) -> Option<Uncertain> {
        let (_, estimate) = self.values.iter().find(|(parameter, _)| *parameter == name)?;
        estimate.value.is_finite().then_some(*estimate)
    }

    /// Returns the correlation of the errors of two estimates.
    pub fn correlation(&self, one: &str, other: &str) -> f64 {
        (self.correlation)(one, other)
    }

    /// Iterates over the parameters with finite estimates.
    pub fn finite(&self) -> impl Iterator<Item = (&'static str, Uncertain)> {
        self.values.iter().copied().filter(|(_, estimate)| estimate.value.is_finite())
    }

    /// Whether the first significant value is negative; where none is significant, the first that is not 0.
    pub fn is_negative(&self) -> bool {
        let decides = self.values.iter().find(|(_, estimate)| estimate.stands_out());
        let decides = decides.or_else(|| self.values.iter().find(|(_, estimate)| estimate.value != 0.0));
        decides.is_some_and(|(_, estimate)| estimate.value < 0.0)
    }

    /// Lists the estimates as "pitch_rad = 0.0178 ± 0.0004".
    pub fn listed(&self) -> String {
        let texts: Vec<String> = self
            .values
            .iter()
            .map(|(name, estimate)| format!("{name} = {}", with_sigma(estimate.value, estimate.sigma)))
            .collect();
        if texts.is_empty() { "of unknown size".to_owned() } else { texts.join(", ") }
    }
}
