//! Offsets of lines that are far above noise and pose errors although they form no pattern.

use crate::{
    diagnostics::detector::{Detector, FitResiduals},
    diagnostics::finding::Finding,
    inference::held_out::ChannelGap,
    inference::model_error::ModelError,
    measurement::quantity::Channel,
    thresholds::Thresholds,
};

/// Smallest ratio of the geometry's residuals to their noise floor that is reported.
const LEAST_RATIO: f64 = Thresholds::DEFAULT.diagnostics.least_scatter_ratio;

/// Detector of geometric residuals far above the noise floor.
pub(crate) struct Scatter;

impl Detector for Scatter {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        let geometry = fit.geometry_at_measured_poses();
        geometry.and_then(|gap| scatter(gap, fit.model_error)).into_iter().collect()
    }
}

/// Returns the scatter of the geometric residuals, if it is far above the noise floor.
fn scatter(gap: &ChannelGap, model_error: &ModelError) -> Option<Finding> {
    let channel = Channel::Geometry;
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
        scatter(&gap, model_error)
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
