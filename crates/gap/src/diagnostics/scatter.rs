//! Lines that are off by far more than noise and the poses' errors make, although on the whole in no pattern.

use std::collections::BTreeMap;

use crate::{
    diagnostics::detector::{Detector, FitResiduals},
    diagnostics::finding::Finding,
    inference::held_out::ChannelGap,
    inference::model_error::ModelError,
    measurement::quantity::Channel,
    recording::ReferenceSource,
    thresholds::Thresholds,
};

/// Smallest ratio of the geometry's residuals to their noise floor that is reported.
const LEAST_RATIO: f64 = Thresholds::DEFAULT.diagnostics.least_scatter_ratio;

/// Finds residuals of geometry that are far above the noise floor.
pub(crate) struct Scatter;

impl Detector for Scatter {
    /// Poses that were found in the pictures scatter themselves: nothing is told of those.
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        match fit.recording.source {
            ReferenceSource::Measured => Vec::from_iter(scatter(fit.gaps, fit.model_error)),
            ReferenceSource::Tagged => Vec::new(),
        }
    }
}

/// Returns the geometry's residuals where they are far above their floor.
fn scatter(gaps: &BTreeMap<Channel, ChannelGap>, model_error: &ModelError) -> Option<Finding> {
    let channel = Channel::Geometry;
    let gap = gaps.get(&channel)?;
    let off = model_error.most_off(channel);
    (gap.after > LEAST_RATIO * gap.floor.hypot(off)).then_some(Finding::Scatter {
        channel,
        size: gap.after,
        floor: gap.floor,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::quantity::Quantity;

    fn scatter_at(after: f64, model_error: &ModelError) -> Option<Finding> {
        let gap = ChannelGap { before: after, after, floor: 0.5 };
        scatter(&BTreeMap::from([(Channel::Geometry, gap)]), model_error)
    }

    #[test]
    fn what_is_far_above_the_floor_is_told_with_its_size() {
        let nothing = ModelError::default();
        assert_eq!(scatter_at(0.6, &nothing), None);
        let found = Finding::Scatter { channel: Channel::Geometry, size: 1.4, floor: 0.5 };
        assert_eq!(scatter_at(1.4, &nothing), Some(found));
    }

    #[test]
    fn a_model_that_explains_much_may_be_off_by_a_part_of_it() {
        // A model that explains 30 pixels may be off by one.
        assert_eq!(scatter_at(1.4, &ModelError::by(Quantity::LineOffset, 30.0)), None);
    }
}
