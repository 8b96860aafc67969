//! Covariance of the parameters.

use nalgebra::{Cholesky, DMatrix};

use crate::adjust::Adjusted;

impl Adjusted {
    /// Returns the covariance of the parameters: what independent errors of the lines would leave, enlarged in every direction
    /// in which the pictures contradict each other more than that. The pictures are the clusters of White's estimator
    /// (Liang and Zeger, "Longitudinal data analysis using generalized linear models", 1986): the errors of one picture may
    /// depend on each other in any way. Returns `None` if the equations cannot be inverted.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let size = self.information.nrows();
        if size == 0 {
            return Some(DMatrix::zeros(0, 0));
        }
        let pictures = self.used.iter().filter(|used| **used).count() as f64;
        // As for a sample's variance, the fit has taken up a part of the contradiction.
        let correction = pictures / (pictures - size as f64).max(1.0);
        let lower = Cholesky::new(self.information.clone())?.l();
        let half = lower.clone().try_inverse()?;
        // In these coordinates independent errors have the identity as covariance.
        let whitened = &half * &self.pulls * half.transpose();
        let axes = (0.5 * (&whitened + whitened.transpose())).symmetric_eigen();
        let enlarged = axes.eigenvalues.map(|value| (correction * value).max(1.0));
        let middle = &axes.eigenvectors * DMatrix::from_diagonal(&enlarged) * axes.eigenvectors.transpose();
        Some(half.transpose() * middle * half)
    }
}
