//! Standard deviations of the reference poses' errors.

use reality_sim_core::statistics::median;

use crate::{
    linear_model::{fitted_residuals::FittedResiduals, robust_weights::SIGMA_BY_MAD},
    recording::ReferenceKind,
};

/// Standard deviations assumed at first: rotations (radians), positions (metres).
const WIDE: [f64; 2] = [0.01, 0.02];
/// Standard deviations of usual motion capture, the centre of the prior.
const USUAL: [f64; 2] = [0.0025, 0.003];
/// Weight of the prior, as a part of a recording's weight.
const USUAL_WEIGHT: f64 = 0.3;
/// Least standard deviations.
const NARROW: [f64; 2] = [2e-4, 5e-4];
/// Standard deviations of yaw (radians), x and y (metres) where these come from the pictures: as good as free.
const FREE: [f64; 3] = [0.1, 0.3, 0.3];

/// Estimates the standard deviations of the poses' errors, in the order of
/// [`crate::linear_model::pose_gradient::pose_gradient`]; without fits, returns those assumed at first.
///
/// One step of expectation maximisation with an inverse gamma prior: the variance is that of the estimated errors' changes
/// from frame to frame (slow changes are no error of the reference) plus the median posterior variance, without which
/// errors that are hardly observed would shrink to nothing. The prior keeps them from staying as wide as assumed at first.
pub(super) fn pose_sigmas(fits: Option<&[FittedResiduals]>, reference: ReferenceKind) -> [f64; 6] {
    let mut sigmas = [WIDE[0], WIDE[0], WIDE[0], WIDE[1], WIDE[1], WIDE[1]];
    if let Some(fits) = fits {
        for (axis, sigma) in sigmas.iter_mut().enumerate() {
            let steps: Vec<f64> =
                fits.windows(2).map(|pair| (pair[1].pose[axis] - pair[0].pose[axis]).abs()).collect();
            let unknown: Vec<f64> = fits.iter().map(|fit| fit.pose_variance[axis]).collect();
            let scatter = SIGMA_BY_MAD * median(steps) / std::f64::consts::SQRT_2;
            let found = scatter * scatter + median(unknown);
            let usual = USUAL[axis / 3].powi(2);
            let variance = (found + USUAL_WEIGHT * usual) / (1.0 + USUAL_WEIGHT);
            *sigma = variance.sqrt().max(NARROW[axis / 3]);
        }
    }
    if reference == ReferenceKind::Attitude {
        [sigmas[1], sigmas[3], sigmas[4]] = FREE;
    }
    sigmas
}
