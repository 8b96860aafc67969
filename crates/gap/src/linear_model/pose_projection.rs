//! The pose's error projected out of a frame's linearised measurements.

use std::collections::BTreeMap;

use nalgebra::{Matrix6, Vector6};

use crate::{
    linear_model::{column::ColumnIndex, linearized_frame::LinearizedFrame},
    measurement::quantity::Quantity,
};

/// Precision matrix `Λ` of the pose's error, from its standard deviations.
pub(super) fn prior_precision(sigmas: &[f64; 6]) -> Matrix6<f64> {
    Matrix6::from_diagonal(&Vector6::from(sigmas.map(|sigma| sigma.powi(-2))))
}

/// `(Pᵀ W P + Λ)⁻¹ Pᵀ W J`: for each column that moves lines, the change of the pose that is most like it.
pub(super) struct PoseProjection {
    /// Columns that move lines, in order.
    pub(super) columns: Vec<ColumnIndex>,
    pub(super) changes: Vec<Vector6<f64>>,
}

impl PoseProjection {
    pub(super) fn new(frame: &LinearizedFrame, weights: &[f64], pose_sigmas: &[f64; 6]) -> Self {
        let mut normal = prior_precision(pose_sigmas);
        let mut cross: BTreeMap<ColumnIndex, Vector6<f64>> = BTreeMap::new();
        for (row, (pose, &weight)) in frame.pose.iter().zip(weights).enumerate() {
            if weight > 0.0 && frame.measurements[row].quantity == Quantity::LineOffset {
                normal.ger(weight, pose, pose, 1.0);
                for &(column, change) in &frame.jacobian[row] {
                    *cross.entry(column).or_insert_with(Vector6::zeros) += weight * change * pose;
                }
            }
        }
        // Squares and a prior precision: positive definite but for rounding.
        let normal = normal.cholesky();
        let solve = |right: Vector6<f64>| match &normal {
            Some(normal) => normal.solve(&right),
            None => Vector6::zeros(),
        };
        let (columns, changes) = cross.into_iter().map(|(column, cross)| (column, solve(cross))).unzip();
        Self { columns, changes }
    }
}
