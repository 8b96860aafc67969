//! Lines that are not where the model predicts them, beyond what other things on the field hide.
//!
//! Where much is missing from a model, few lines are found near their predicted places. The sizes of the residuals of these few tell
//! nothing of the others.

use crate::{
    diagnostics::detector::{Detector, FitResiduals},
    diagnostics::finding::Finding,
    thresholds::Thresholds,
};

/// Smallest share that is reported.
const LEAST_SHARE: f64 = Thresholds::DEFAULT.diagnostics.least_unexplained_lines;

/// Detector of lines that are not where they should be.
pub(crate) struct UnexplainedLines;

impl Detector for UnexplainedLines {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        let share = fit.geometry_at_measured_poses().map(|gap| gap.left_out);
        share.and_then(unexplained).into_iter().collect()
    }
}

/// Returns the finding for a share of the lines' pieces that are not where they should be.
fn unexplained(share: f64) -> Option<Finding> {
    (share > LEAST_SHARE).then_some(Finding::UnexplainedLines { share })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_hidden_lines_are_ordinary_and_many_that_are_off_are_reported() {
        assert_eq!(unexplained(0.12), None);
        assert_eq!(unexplained(0.4), Some(Finding::UnexplainedLines { share: 0.4 }));
    }
}
