//! Comparison of fitted models by the likelihood of their residuals.

use std::collections::BTreeMap;

use nalgebra::DVector;

use crate::{
    inference::linearized_recording::LinearizedRecording,
    inference::split::HeldOutSplit,
    linear_model::parameters::FittedParameter,
    linear_model::reduced_equations::ReducedEquations,
    linear_model::{fitted_residuals::FittedResiduals, robust_weights::INDEPENDENT, system::LinearSystem},
    measurement::quantity::Quantity,
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// Difference in log-likelihood below which two fitted models fit equally well, if the better one explains `explained`. No
/// model is exact, and its error grows with what it explains.
pub(crate) fn indistinguishable_below(explained: f64) -> f64 {
    let score = THRESHOLDS.distinguishable_score;
    (0.5 * score * score).max(THRESHOLDS.compared_model_error * explained)
}

/// Minus log-likelihood of the training frames under a fitted model. It adds up the squared residuals in the standard
/// deviations of one system, clipped at outliers, and the squared nuisance parameters that the fit needs. Infinite if the
/// nuisance parameters cannot be fitted.
pub(crate) fn minus_log_likelihood(
    linearized: &LinearizedRecording,
    system: &LinearSystem,
    columns: &[FittedParameter],
    split: &HeldOutSplit,
) -> f64 {
    // The effects keep their values; only the nuisance parameters are fitted.
    let own = &linearized.system;
    let equations = ReducedEquations::new(own.frames.iter(), &own.columns);
    let Some(fit) = equations.fit(&[], &DVector::zeros(columns.len())) else { return f64::INFINITY };
    let nuisance_penalty = own.columns.nuisance_energy(fit.delta.as_slice());
    let mut means: BTreeMap<Quantity, (f64, f64)> = BTreeMap::new();
    for (frame, weights) in split.training().zip(&own.weights) {
        let frame = &linearized.frames[frame];
        let fitted = FittedResiduals::new(frame, weights, &fit.delta, &own.columns, &system.pose_sigmas);
        let residuals = frame.measurements.iter().zip(&fitted.residuals);
        for (measurement, residual) in residuals.filter(|(_, residual)| residual.is_finite()) {
            if let Some(sigma) = system.sigmas.get(&measurement.quantity) {
                let mean = means.entry(measurement.quantity).or_default();
                let most = THRESHOLDS.compared_residual_sigmas * THRESHOLDS.compared_residual_sigmas;
                mean.0 += (residual / sigma).powi(2).min(most);
                mean.1 += 1.0;
            }
        }
    }
    // Models differ in the number of lines that they find. Hence each quantity counts by its mean, times the number of
    // independent measurements.
    let counted = means.iter().map(|(quantity, (sum, count))| {
        let independent = if quantity.is_proprioceptive() {
            THRESHOLDS.odometry_rows
        } else {
            INDEPENDENT * THRESHOLDS.picture_rows
        };
        0.5 * independent * sum / count.max(1.0)
    });
    counted.sum::<f64>() + nuisance_penalty
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_difference_that_counts_grows_with_what_the_better_model_explains() {
        let score = THRESHOLDS.distinguishable_score;
        assert_eq!(indistinguishable_below(0.0), 0.5 * score * score);
        assert!(indistinguishable_below(1000.0) > indistinguishable_below(100.0));
        assert!(
            indistinguishable_below(1000.0) < 100.0,
            "models that differ by a tenth of what they explain are distinguishable"
        );
    }
}
