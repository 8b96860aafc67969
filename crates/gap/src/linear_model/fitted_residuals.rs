//! Residuals of one frame after a fit.

use nalgebra::{DVector, Matrix6, Vector6};

use crate::linear_model::{
    column::{ColumnIndex, Columns},
    linearized_frame::LinearizedFrame,
    pose_projection::prior_precision,
};

/// Residuals of a frame after a change of the columns, with the pose refitted.
pub(crate) struct FittedResiduals {
    pub(crate) residuals: Vec<f64>,
    /// Estimated error of the reference pose.
    pub(crate) pose_error: Vector6<f64>,
    /// Posterior variances of the pose error.
    pub(super) pose_variance: Vector6<f64>,
}

impl FittedResiduals {
    /// Returns `r − J δ − P b` with the maximum a posteriori pose error `b = (Pᵀ W P + Λ)⁻¹ Pᵀ W (r − J δ)`.
    pub(crate) fn new(
        frame: &LinearizedFrame,
        weights: &[f64],
        delta: &DVector<f64>,
        columns: &Columns,
        pose_sigmas: &[f64; 6],
    ) -> Self {
        let change = |derivatives: &Vec<(ColumnIndex, f64)>| {
            derivatives.iter().map(|(column, derivative)| derivative * delta[column.0]).sum::<f64>()
        };
        let mut residuals: Vec<f64> = frame
            .residuals
            .iter()
            .zip(frame.jacobian.iter().zip(&frame.patches))
            .map(|(residual, (derivatives, patch))| {
                let reflectance =
                    patch.map_or(0.0, |(patch, derivative)| derivative * delta[columns.of_patch(patch).0]);
                residual - change(derivatives) - reflectance
            })
            .collect();
        let (mut normal, mut gradient) = (prior_precision(pose_sigmas), Vector6::zeros());
        for ((pose_gradient, &weight), residual) in frame.pose_gradients.iter().zip(weights).zip(&residuals) {
            if weight > 0.0 {
                normal.ger(weight, pose_gradient, pose_gradient, 1.0);
                gradient += weight * residual * pose_gradient;
            }
        }
        // A sum of squares and a prior precision is positive definite, except for rounding.
        let covariance = normal.cholesky().map_or_else(Matrix6::zeros, |normal| normal.inverse());
        let pose_error = covariance * gradient;
        for (residual, pose_gradient) in residuals.iter_mut().zip(&frame.pose_gradients) {
            *residual -= pose_gradient.dot(&pose_error);
        }
        Self { residuals, pose_error, pose_variance: covariance.diagonal() }
    }

    /// Returns the sum of squares of the estimated pose error, in its standard deviations.
    pub(crate) fn pose_penalty(&self, pose_sigmas: &[f64; 6]) -> f64 {
        self.pose_error.dot(&(prior_precision(pose_sigmas) * self.pose_error))
    }
}
