//! Residuals that a fit leaves in one frame.

use nalgebra::{DVector, Matrix6, Vector6};

use crate::linear_model::{
    column::ColumnIndex, linearized_frame::LinearizedFrame, pose_projection::prior_precision,
};

/// What a change of the columns and the best pose beside it leave of a frame's residuals.
pub(crate) struct FittedResiduals {
    pub(crate) residuals: Vec<f64>,
    /// Estimated error of the reference pose.
    pub(super) pose: Vector6<f64>,
    /// Posterior variances of that estimate.
    pub(super) pose_variance: Vector6<f64>,
}

impl FittedResiduals {
    /// `r − J δ − P b` with the maximum a posteriori pose error `b = (Pᵀ W P + Λ)⁻¹ Pᵀ W (r − J δ)`.
    pub(crate) fn new(
        frame: &LinearizedFrame,
        weights: &[f64],
        delta: &DVector<f64>,
        pose_sigmas: &[f64; 6],
    ) -> Self {
        let change = |row: &Vec<(ColumnIndex, f64)>| {
            row.iter().map(|(column, value)| value * delta[column.0]).sum::<f64>()
        };
        let mut residuals: Vec<f64> = frame
            .residuals
            .iter()
            .zip(&frame.jacobian)
            .map(|(residual, row)| residual - change(row))
            .collect();
        let (mut normal, mut gradient) = (prior_precision(pose_sigmas), Vector6::zeros());
        for ((pose, &weight), residual) in frame.pose.iter().zip(weights).zip(&residuals) {
            if weight > 0.0 {
                normal.ger(weight, pose, pose, 1.0);
                gradient += weight * residual * pose;
            }
        }
        // Squares and a prior precision: positive definite but for rounding.
        let covariance = normal.cholesky().map_or_else(Matrix6::zeros, |normal| normal.inverse());
        let pose = covariance * gradient;
        for (residual, row) in residuals.iter_mut().zip(&frame.pose) {
            *residual -= row.dot(&pose);
        }
        Self { residuals, pose, pose_variance: covariance.diagonal() }
    }
}
