//! Offsets of lines that are far above noise and pose errors although they form no pattern.

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

/// Detector of geometric residuals far above the noise floor.
pub(crate) struct Scatter;

impl Detector for Scatter {
    /// Reports nothing for poses estimated from the pictures, which scatter themselves.
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        match fit.recording.source {
            ReferenceSource::Measured => Vec::from_iter(scatter(fit.left, fit.model_error)),
            ReferenceSource::Tagged => Vec::new(),
        }
    }
}

/// Returns the scatter of the geometric residuals, if it is far above the noise floor.
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
        let gap = ChannelGap { before: after, after, floor: 0.5, left_out: 0.0 };
        scatter(&BTreeMap::from([(Channel::Geometry, gap)]), model_error)
    }

    #[test]
    fn scatter_far_above_the_floor_is_reported_with_its_size() {
        let nothing = ModelError::default();
        assert_eq!(scatter_at(0.6, &nothing), None);
        let found = Finding::Scatter { channel: Channel::Geometry, size: 1.4, floor: 0.5 };
        assert_eq!(scatter_at(1.4, &nothing), Some(found));
    }

    #[test]
    fn scatter_within_the_model_error_is_not_reported() {
        // A model that explains 30 pixels may be off by 1.2 pixels.
        assert_eq!(scatter_at(1.4, &ModelError::by(Quantity::LineOffset, 30.0)), None);
    }
}
