//! Standard deviations of the errors of the reference poses.

use reality_sim_core::statistics::{median, robust_sigma};

use crate::{
    linear_model::fitted_residuals::FittedResiduals,
    recording::ReferenceKind,
    thresholds::{PoseErrorThresholds, Thresholds},
};

const THRESHOLDS: PoseErrorThresholds = Thresholds::DEFAULT.linear_model.pose_error;

/// Estimates the standard deviations of the pose errors, in the order of
/// [`crate::linear_model::pose_gradient::pose_gradient`]; without fits, returns the initial values.
///
/// This is one step of expectation maximisation with an inverse gamma prior. The variance is that of the changes of the
/// estimated errors from frame to frame, because slow changes are not errors of the reference, plus the median posterior
/// variance, without which errors that are hardly observed would shrink to zero. The prior keeps the variances of such errors
/// from staying at their initial values.
pub(super) fn pose_sigmas(fits: Option<&[FittedResiduals]>, reference: ReferenceKind) -> [f64; 6] {
    let (wide, weight) = (THRESHOLDS.initial, THRESHOLDS.prior_weight);
    let mut sigmas = [wide[0], wide[0], wide[0], wide[1], wide[1], wide[1]];
    if let Some(fits) = fits {
        for (axis, sigma) in sigmas.iter_mut().enumerate() {
            let steps: Vec<f64> = fits
                .windows(2)
                .map(|pair| (pair[1].pose_error[axis] - pair[0].pose_error[axis]).abs())
                .collect();
            let posterior: Vec<f64> = fits.iter().map(|fit| fit.pose_variance[axis]).collect();
            let scatter = robust_sigma(steps) / std::f64::consts::SQRT_2;
            let estimated = scatter * scatter + median(posterior);
            let usual = THRESHOLDS.usual[axis / 3].powi(2);
            let variance = (estimated + weight * usual) / (1.0 + weight);
            *sigma = variance.sqrt().max(THRESHOLDS.least[axis / 3]);
        }
    }
    if reference == ReferenceKind::Attitude {
        [sigmas[1], sigmas[3], sigmas[4]] = THRESHOLDS.free;
    }
    sigmas
}
