//! Variances of the increments of reflectance from a patch to the patches within it.

use std::collections::BTreeMap;

use super::tree::Scale;
use crate::thresholds::{ReflectanceThresholds, Thresholds};

const THRESHOLDS: ReflectanceThresholds = Thresholds::DEFAULT.linear_model.reflectance;

/// Number of colours that share most of their reflectance.
const COLORS: f64 = 3.0;

/// Variance of the increments of each scale, of the natural logarithm of the reflectance.
#[derive(Debug, Clone)]
pub(crate) struct IncrementVariances(BTreeMap<Scale, f64>);

impl IncrementVariances {
    /// Creates the variances from those of each scale.
    pub(super) fn new(of_scale: impl Fn(Scale) -> f64) -> Self {
        Self(Scale::all().map(|scale| (scale, of_scale(scale))).collect())
    }

    /// Returns the variances that are assumed before anything was seen.
    pub(super) fn usual() -> Self {
        Self::new(|_| THRESHOLDS.usual_increment.powi(2))
    }

    /// Returns the variance of a scale.
    pub(crate) fn of(&self, scale: Scale) -> f64 {
        self.0.get(&scale).copied().unwrap_or(THRESHOLDS.usual_increment.powi(2))
    }

    /// Returns the variances with which the three colours of one brightness tell as much as one of them.
    pub(super) fn of_shared_brightness(&self) -> Self {
        Self(self.0.iter().map(|(scale, variance)| (*scale, COLORS * variance)).collect())
    }
}
