//! Lines that are not where the model predicts them, beyond what other things on the field hide.
//!
//! Where much is missing from a model, few lines are found near their predicted places. The sizes of the residuals of these few tell
//! nothing of the others.

use std::collections::BTreeMap;

use crate::{
    diagnostics::detector::{Detector, FitResiduals},
    diagnostics::finding::Finding,
    inference::held_out::ChannelGap,
    measurement::quantity::Channel,
    recording::ReferenceSource,
    thresholds::Thresholds,
};

/// Smallest share that is reported.
const LEAST_SHARE: f64 = Thresholds::DEFAULT.diagnostics.least_unexplained_lines;

/// Detector of lines that are not where they should be.
pub(crate) struct UnexplainedLines;

impl Detector for UnexplainedLines {
    /// Reports nothing for poses estimated from the pictures: lost ones are far off.
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        match fit.recording.source {
            ReferenceSource::Measured => Vec::from_iter(unexplained(fit.left)),
            ReferenceSource::Tagged => Vec::new(),
        }
    }
}

fn unexplained(gaps: &BTreeMap<Channel, ChannelGap>) -> Option<Finding> {
    let share = gaps.get(&Channel::Geometry)?.left_out;
    (share > LEAST_SHARE).then_some(Finding::UnexplainedLines { share })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_hidden_lines_are_ordinary_and_many_that_are_off_are_reported() {
        let with = |left_out| {
            let gap = ChannelGap { before: 0.5, after: 0.5, floor: 0.5, left_out };
            unexplained(&BTreeMap::from([(Channel::Geometry, gap)]))
        };
        assert_eq!(with(0.16), None);
        assert_eq!(with(0.39), Some(Finding::UnexplainedLines { share: 0.39 }));
        assert_eq!(unexplained(&BTreeMap::new()), None);
    }
}
