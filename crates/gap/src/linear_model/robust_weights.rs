//! Robust weights and standard deviations of residuals, quantity by quantity.

use std::collections::BTreeMap;

use reality_sim_core::statistics::median;

use crate::{
    linear_model::linearized_frame::LinearizedFrame,
    measurement::{quantity::Quantity, scalar::Measurement},
    thresholds::Thresholds,
};

/// Cut-off of Tukey's biweight, standard deviations.
const TUKEY: f64 = Thresholds::DEFAULT.linear_model.tukey_sigmas;
/// Information of a picture's measurements, as a part of that of as many independent ones.
pub(crate) const INDEPENDENT: f64 = Thresholds::DEFAULT.linear_model.independent_share;
/// Standard deviation of a normal distribution by its median absolute deviation.
pub(super) const SIGMA_BY_MAD: f64 = 1.4826;

/// Weights of measurements by Tukey's biweight of their residuals (Huber & Ronchetti 2009, section 4.8), divided by the
/// residual's variance.
pub(crate) fn weigh(
    frame: &LinearizedFrame,
    residuals: &[f64],
    sigmas: &BTreeMap<Quantity, f64>,
) -> Vec<f64> {
    let weight = |(row, residual): (&Measurement, &f64)| {
        let Some(&sigma) = sigmas.get(&row.quantity) else { return 0.0 };
        let variance = sigma * sigma + row.sigma * row.sigma;
        let outlying = (residual * residual / (TUKEY * TUKEY * variance)).min(1.0);
        let independent = if row.quantity.is_odometry() { 1.0 } else { INDEPENDENT };
        if residual.is_finite() { independent * (1.0 - outlying).powi(2) / variance } else { 0.0 }
    };
    frame.measurements.iter().zip(residuals).map(weight).collect()
}

/// Residuals of all frames with their measurements.
pub(super) fn all_of<'a>(
    frames: &'a [&'a LinearizedFrame],
    residuals: impl Iterator<Item = &'a Vec<f64>>,
) -> impl Iterator<Item = (&'a Measurement, f64)> {
    frames
        .iter()
        .zip(residuals)
        .flat_map(|(frame, values)| frame.measurements.iter().zip(values.iter().copied()))
}

/// Residuals that the first weights come from: those of the odometry are taken about their medians. Else an effect that
/// lengthens all steps forward would take their weight, and leave it to the steps aside, which show little but the
/// reference's errors.
pub(super) fn first_residuals(frames: &[&LinearizedFrame]) -> Vec<Vec<f64>> {
    let mut groups: BTreeMap<Quantity, Vec<f64>> = BTreeMap::new();
    for (row, value) in all_of(frames, frames.iter().map(|frame| &frame.residuals)) {
        if row.quantity.is_odometry() && value.is_finite() {
            groups.entry(row.quantity).or_default().push(value);
        }
    }
    let medians: BTreeMap<Quantity, f64> =
        groups.into_iter().map(|(group, values)| (group, median(values))).collect();
    let about = |(row, value): (&Measurement, &f64)| value - medians.get(&row.quantity).unwrap_or(&0.0);
    frames.iter().map(|frame| frame.measurements.iter().zip(&frame.residuals).map(about).collect()).collect()
}

/// Standard deviation of each quantity's residuals about zero, by the median absolute deviation.
pub(super) fn sigmas_by_quantity<'a>(
    rows: impl Iterator<Item = (&'a Measurement, f64)>,
) -> BTreeMap<Quantity, f64> {
    let mut groups: BTreeMap<Quantity, Vec<f64>> = BTreeMap::new();
    for (row, residual) in rows.filter(|(_, residual)| residual.is_finite()) {
        groups.entry(row.quantity).or_default().push(residual.abs());
    }
    groups.into_iter().map(|(group, values)| (group, (SIGMA_BY_MAD * median(values)).max(1e-6))).collect()
}
