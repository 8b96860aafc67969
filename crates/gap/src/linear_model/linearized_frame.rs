//! Residuals of one frame with their derivatives.

use nalgebra::Vector6;

use crate::{
    linear_model::{column::ColumnIndex, reflectance::PatchIndex},
    measurement::{quantity::Channel, scalar::Measurement},
};

/// Measurements, residuals and Jacobian of one frame.
#[derive(Debug, Clone)]
pub(crate) struct LinearizedFrame {
    pub(crate) measurements: Vec<Measurement>,
    /// Measured minus predicted values; not a number where either is missing.
    pub(crate) residuals: Vec<f64>,
    /// Sparse rows of the Jacobian of the predictions: columns with their derivatives, in the order of the columns.
    pub(crate) jacobian: Vec<Vec<(ColumnIndex, f64)>>,
    /// Smallest patch of the field in which a level was measured, with the derivative by the logarithm of its reflectance.
    pub(crate) patches: Vec<Option<(PatchIndex, f64)>>,
    /// Gradients of line offsets with respect to the pose, see
    /// [`crate::linear_model::pose_gradient::pose_gradient`]; zero for other measurements.
    pub(crate) pose_gradients: Vec<Vector6<f64>>,
}

impl LinearizedFrame {
    /// Returns the frame with a reference pose that has no error.
    pub(crate) fn at_exact_pose(mut self) -> Self {
        self.pose_gradients.fill(Vector6::zeros());
        self
    }

    /// Returns the frame with one reflectance of carpet and one of paint.
    pub(crate) fn on_even_surfaces(mut self) -> Self {
        self.patches.fill(None);
        self
    }

    /// Marks the residuals of a channel as missing, so that they are not fitted.
    pub(crate) fn leave_out(&mut self, channel: Channel) {
        for (row, residual) in self.measurements.iter().zip(&mut self.residuals) {
            if row.quantity.channel() == channel {
                *residual = f64::NAN;
            }
        }
    }
}
