//! Variances of the increments of reflectance from a patch to the patches within it.

use std::collections::BTreeMap;

use super::{Eliminated, ReflectanceField, tree::Scale};
use crate::thresholds::{ReflectanceThresholds, Thresholds};

const THRESHOLDS: ReflectanceThresholds = Thresholds::DEFAULT.linear_model.reflectance;

/// Number of colours that share most of their reflectance.
const COLORS: f64 = 3.0;

/// Variance of the increments of each scale, of the natural logarithm of the reflectance.
#[derive(Debug, Clone)]
pub(crate) struct IncrementVariances(BTreeMap<Scale, f64>);

impl IncrementVariances {
    /// Returns the variances that are assumed before anything was seen.
    pub(super) fn usual() -> Self {
        Self(Scale::all().map(|scale| (scale, THRESHOLDS.usual_increment.powi(2))).collect())
    }

    /// Returns the variance of a scale.
    pub(crate) fn of(&self, scale: Scale) -> f64 {
        self.0.get(&scale).copied().unwrap_or(THRESHOLDS.usual_increment.powi(2))
    }

    /// Returns the variances with which the three colours of one brightness tell as much as one of them.
    pub(super) fn of_shared_brightness(&self) -> Self {
        Self(self.0.iter().map(|(scale, variance)| (*scale, COLORS * variance)).collect())
    }

    /// Estimates the variances from the values of a fit: one step of expectation maximisation with an inverse gamma prior
    /// (Dempster, Laird and Rubin 1977). Each increment counts with its posterior variance, or increments that are hardly
    /// seen would shrink to nothing.
    pub(crate) fn estimated(field: &ReflectanceField, fitted: &Eliminated, values: &[f64]) -> Self {
        let usual = THRESHOLDS.usual_increment.powi(2);
        let mut sums: BTreeMap<Scale, (f64, f64)> = BTreeMap::new();
        let posterior = fitted.increment_variances(field);
        for ((patch, increment), variance) in field.increments(values).zip(posterior) {
            let sum = sums.entry(field.tree.scale(patch)).or_default();
            *sum = (sum.0 + increment * increment + variance, sum.1 + 1.0);
        }
        let weight = THRESHOLDS.prior_increments;
        let variance = |scale: Scale| {
            let (sum, count) = sums.get(&scale).copied().unwrap_or_default();
            (scale, ((sum + weight * usual) / (count + weight)).max(THRESHOLDS.least_increment.powi(2)))
        };
        Self(Scale::all().map(variance).collect())
    }
}
