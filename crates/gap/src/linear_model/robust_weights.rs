//! Robust weights and standard deviations of residuals, quantity by quantity.

use std::collections::BTreeMap;

use reality_sim_core::statistics::{median, robust_sigma};

use crate::{
    linear_model::linearized_frame::LinearizedFrame,
    measurement::{quantity::Quantity, scalar::Measurement},
    thresholds::Thresholds,
};

/// Cut-off of Tukey's biweight, standard deviations.
const CUTOFF: f64 = Thresholds::DEFAULT.linear_model.tukey_sigmas;
/// Information of a picture's measurements as a fraction of that of as many independent ones.
pub(crate) const INDEPENDENT: f64 = Thresholds::DEFAULT.linear_model.independent_share;

/// Returns the weights of a frame's measurements: Tukey's biweight of their residuals (Huber and Ronchetti 2009,
/// section 4.8), divided by the residual's variance. The weight is 0 for outliers and missing residuals.
pub(crate) fn weigh(
    frame: &LinearizedFrame,
    residuals: &[f64],
    sigmas: &BTreeMap<Quantity, f64>,
) -> Vec<f64> {
    weigh_by_scale(frame, residuals, sigmas, sigmas)
}

/// Returns the same weights, with outliers told by other standard deviations than those of the noise: where the fit is still far
/// off, by the residuals' own scale.
pub(crate) fn weigh_by_scale(
    frame: &LinearizedFrame,
    residuals: &[f64],
    sigmas: &BTreeMap<Quantity, f64>,
    scales: &BTreeMap<Quantity, f64>,
) -> Vec<f64> {
    let weight = |(measurement, residual): (&Measurement, &f64)| {
        let quantity = &measurement.quantity;
        let (Some(&sigma), Some(&scale)) = (sigmas.get(quantity), scales.get(quantity)) else { return 0.0 };
        let variance = |sigma: f64| sigma * sigma + measurement.sigma * measurement.sigma;
        let outlying = (residual * residual / (CUTOFF * CUTOFF * variance(scale))).min(1.0);
        let independent = if quantity.is_proprioceptive() { 1.0 } else { INDEPENDENT };
        if residual.is_finite() { independent * (1.0 - outlying).powi(2) / variance(sigma) } else { 0.0 }
    };
    frame.measurements.iter().zip(residuals).map(weight).collect()
}

/// Iterates over the measurements of all frames, each with its residual.
pub(super) fn with_residuals<'a>(
    frames: &'a [&'a LinearizedFrame],
    residuals: impl Iterator<Item = &'a Vec<f64>>,
) -> impl Iterator<Item = (&'a Measurement, f64)> {
    frames
        .iter()
        .zip(residuals)
        .flat_map(|(frame, values)| frame.measurements.iter().zip(values.iter().copied()))
}

/// Returns the residuals that give the initial weights.
///
/// Residuals of the odometry are taken about their medians. Otherwise an effect that lengthens all steps forward would make
/// outliers of them, and only the steps to the side would keep their weights, which show little but errors of the reference.
pub(super) fn first_residuals(frames: &[&LinearizedFrame]) -> Vec<Vec<f64>> {
    let mut by_quantity: BTreeMap<Quantity, Vec<f64>> = BTreeMap::new();
    for (measurement, value) in with_residuals(frames, frames.iter().map(|frame| &frame.residuals)) {
        if measurement.quantity.is_proprioceptive() && value.is_finite() {
            by_quantity.entry(measurement.quantity).or_default().push(value);
        }
    }
    let medians: BTreeMap<Quantity, f64> =
        by_quantity.into_iter().map(|(quantity, values)| (quantity, median(values))).collect();
    let centred = |(measurement, value): (&Measurement, &f64)| {
        value - medians.get(&measurement.quantity).unwrap_or(&0.0)
    };
    let of_frame =
        |frame: &&LinearizedFrame| frame.measurements.iter().zip(&frame.residuals).map(centred).collect();
    frames.iter().map(of_frame).collect()
}

/// Returns the standard deviation of each quantity's residuals about zero, from their median absolute deviation.
pub(crate) fn sigmas_by_quantity<'a>(
    residuals: impl Iterator<Item = (&'a Measurement, f64)>,
) -> BTreeMap<Quantity, f64> {
    let mut by_quantity: BTreeMap<Quantity, Vec<f64>> = BTreeMap::new();
    for (measurement, residual) in residuals.filter(|(_, residual)| residual.is_finite()) {
        by_quantity.entry(measurement.quantity).or_default().push(residual.abs());
    }
    by_quantity.into_iter().map(|(quantity, values)| (quantity, robust_sigma(values).max(1e-6))).collect()
}
