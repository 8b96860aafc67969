//! One frame's residuals with their derivatives.

use nalgebra::Vector6;

use crate::{
    linear_model::column::ColumnIndex,
    measurement::{quantity::Channel, scalar::Measurement},
};

/// One frame's measurements, residuals and Jacobian.
#[derive(Debug, Clone)]
pub(crate) struct LinearizedFrame {
    pub(crate) measurements: Vec<Measurement>,
    /// Measured minus predicted; not a number where there is nothing to compare.
    pub(crate) residuals: Vec<f64>,
    /// Rows of the Jacobian of the predictions, sparse: columns with their derivatives, in the order of columns.
    pub(crate) jacobian: Vec<Vec<(ColumnIndex, f64)>>,
    /// Gradients of lines' offsets with respect to the pose, see
    /// [`crate::linear_model::pose_gradient::pose_gradient`]; zero for other measurements.
    pub(crate) pose: Vec<Vector6<f64>>,
}

impl LinearizedFrame {
    /// Leaves a channel out of the comparison.
    pub(crate) fn leave_out(&mut self, channel: Channel) {
        for (row, residual) in self.measurements.iter().zip(&mut self.residuals) {
            if row.quantity.channel() == channel {
                *residual = f64::NAN;
            }
        }
    }
}
