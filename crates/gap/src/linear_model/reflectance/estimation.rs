//! Estimation of the variances of the reflectance's increments from a fit.

use std::collections::BTreeMap;

use super::{elimination::Eliminated, field::ReflectanceField, increments::IncrementVariances, tree::Scale};
use crate::thresholds::{ReflectanceThresholds, Thresholds};

const THRESHOLDS: ReflectanceThresholds = Thresholds::DEFAULT.linear_model.reflectance;

/// Estimates the variances from the values of a fit: one step of expectation maximisation with an inverse gamma prior
/// (Dempster, Laird and Rubin 1977). Each increment counts with its posterior variance, or increments that are hardly
/// seen would shrink to nothing.
pub(crate) fn increment_variances(
    field: &ReflectanceField,
    fitted: &Eliminated,
    values: &[f64],
) -> IncrementVariances {
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
        ((sum + weight * usual) / (count + weight)).max(THRESHOLDS.least_increment.powi(2))
    };
    IncrementVariances::new(variance)
}
