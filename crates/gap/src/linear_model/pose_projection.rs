//! Projection of the pose error out of a frame's linearised measurements.

use std::collections::BTreeMap;

use nalgebra::{Matrix6, Vector6};

use crate::{
    linear_model::{column::ColumnIndex, linearized_frame::LinearizedFrame},
    measurement::quantity::Quantity,
};

/// Precision matrix `Λ` of the pose error, from its standard deviations.
pub(super) fn prior_precision(sigmas: &[f64; 6]) -> Matrix6<f64> {
    Matrix6::from_diagonal(&Vector6::from(sigmas.map(|sigma| sigma.powi(-2))))
}

/// `(Pᵀ W P + Λ)⁻¹ Pᵀ W J`: for each column that moves lines, the change of the pose that moves them most alike.
pub(super) struct PoseProjection {
    /// Columns that move lines, in order.
    pub(super) columns: Vec<ColumnIndex>,
    /// Changes of the pose, one for each of these columns.
    pub(super) pose_changes: Vec<Vector6<f64>>,
}

impl PoseProjection {
    pub(super) fn new(frame: &LinearizedFrame, weights: &[f64], pose_sigmas: &[f64; 6]) -> Self {
        let mut normal = prior_precision(pose_sigmas);
        let mut cross: BTreeMap<ColumnIndex, Vector6<f64>> = BTreeMap::new();
        for (row, (gradient, &weight)) in frame.pose_gradients.iter().zip(weights).enumerate() {
            if weight > 0.0 && frame.measurements[row].quantity == Quantity::LineOffset {
                normal.ger(weight, gradient, gradient, 1.0);
                for &(column, derivative) in &frame.jacobian[row] {
                    *cross.entry(column).or_insert_with(Vector6::zeros) += weight * derivative * gradient;
                }
            }
        }
        // A sum of squares and a prior precision is positive definite, except for rounding.
        let normal = normal.cholesky();
        let solve = |right: Vector6<f64>| match &normal {
            Some(normal) => normal.solve(&right),
            None => Vector6::zeros(),
        };
        let (columns, pose_changes) = cross.into_iter().map(|(column, cross)| (column, solve(cross))).unzip();
        Self { columns, pose_changes }
    }
}
