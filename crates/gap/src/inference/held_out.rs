//! Gap on held-out frames before and after the selection, beside the noise floor.

use std::collections::BTreeMap;

use nalgebra::{DVector, Vector6};
use reality_sim_sensor::Model;

use crate::{
    frame_index::{FrameIndex, PerFrame},
    inference::selected_model::SelectedModel,
    linear_model::linearization::{MeasureError, linearise},
    linear_model::{
        fitted_residuals::FittedResiduals, linearized_frame::LinearizedFrame, robust_weights::weigh,
    },
    measurement::quantity::{Channel, Quantity},
    recording::Recording,
    thresholds::Thresholds,
};

/// Residuals of all frames under a model.
pub(crate) struct HeldOutResiduals {
    /// Residuals at the reference poses and nominal values, by frame and measurement: the errors of a simulator that is
    /// given these poses.
    pub(crate) residuals: PerFrame<Vec<f64>>,
    /// Residuals after the poses were refitted within their errors.
    refitted: PerFrame<Vec<f64>>,
}

/// Root mean squares of one channel's residuals, in the channel's unit.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ChannelGap {
    /// Size with the model as it was given.
    pub before: f64,
    /// Size with the extended model.
    pub after: f64,
    /// Noise floor, from differences of neighbouring measurements in one picture or of successive odometry steps.
    pub floor: f64,
}

impl ChannelGap {
    /// Whether the added effects change the size.
    pub fn has_moved(&self) -> bool {
        has_moved(self.before, self.after)
    }
}

/// Whether a gap has changed by more than measuring the lines anew can change it.
pub(crate) fn has_moved(before: f64, after: f64) -> bool {
    (before - after).abs() > MOVED * before
}

impl HeldOutResiduals {
    /// Computes residuals under `model` of the measurements that were made with the extended model.
    pub(crate) fn new(
        recording: &Recording<'_>,
        found: &SelectedModel,
        model: &Model,
    ) -> Result<Self, MeasureError> {
        let linearized = &found.linearized;
        let frames = linearise(recording, &linearized.measurements, model, &[], &linearized.nuisances)?;
        let nowhere = DVector::zeros(linearized.nuisances.len());
        let sigmas = &linearized.system.pose_sigmas;
        let residual = |frame: &LinearizedFrame, pose_sigmas: &[f64; 6]| {
            let weights = weigh(frame, &frame.residuals, &linearized.system.sigmas);
            FittedResiduals::new(frame, &weights, &nowhere, pose_sigmas).residuals
        };
        Ok(Self {
            residuals: frames.iter().map(|frame| residual(frame, &[1e-12; 6])).collect(),
            refitted: frames.iter().map(|frame| residual(frame, sigmas)).collect(),
        })
    }
}

/// Returns the gap of every measured channel on the held-out frames.
pub(crate) fn gaps(
    found: &SelectedModel,
    before: &HeldOutResiduals,
    after: &HeldOutResiduals,
) -> BTreeMap<Channel, ChannelGap> {
    let mut sums: BTreeMap<Channel, Squares> = BTreeMap::new();
    let mut last: BTreeMap<Quantity, f64> = BTreeMap::new();
    let mut next: Option<FrameIndex> = None;
    for frame in found.split.held_out() {
        let linearized = &found.linearized.frames[frame];
        // Neighbours are measurements in one picture; for the odometry they are successive steps.
        last.retain(|quantity, _| quantity.is_proprioceptive() && Some(frame) == next);
        next = Some(frame.next());
        for (index, measurement) in linearized.measurements.iter().enumerate() {
            let (b, a) = (before.residuals[frame][index], after.residuals[frame][index]);
            let refitted = after.refitted[frame][index];
            let sigma = found.linearized.system.sigmas.get(&measurement.quantity).copied().unwrap_or(0.0);
            // Outliers do not count: they are not measurements of a line or of carpet.
            if !(b.is_finite()
                && a.is_finite()
                && refitted.abs() < Thresholds::DEFAULT.inference.outlying_sigmas * sigma)
            {
                continue;
            }
            let sums = sums.entry(measurement.quantity.channel()).or_default();
            sums.before += b * b;
            sums.after += a * a;
            sums.count += 1.0;
            sums.poses +=
                pose_variance(&linearized.pose_gradients[index], &found.linearized.system.pose_sigmas);
            if let Some(previous) = last.insert(measurement.quantity, refitted) {
                sums.steps += 0.5 * (refitted - previous).powi(2);
                sums.pairs += 1.0;
            }
        }
    }
    sums.into_iter().map(|(channel, sums)| (channel, sums.gap())).collect()
}

/// Relative change of a gap below which it counts as unchanged.
const MOVED: f64 = Thresholds::DEFAULT.inference.least_gap_change;

/// Sums of squares of a channel's residuals.
#[derive(Debug, Clone, Copy, Default)]
struct Squares {
    before: f64,
    after: f64,
    /// Number of residuals.
    count: f64,
    /// Sum of the variances due to the reference poses' errors.
    poses: f64,
    /// Sum of half the squared differences between neighbouring measurements.
    steps: f64,
    /// Number of pairs of neighbours.
    pairs: f64,
}

impl Squares {
    /// Returns the root mean squares.
    fn gap(&self) -> ChannelGap {
        let mean = |sum: f64| sum / self.count.max(1.0);
        let (before, after) = (mean(self.before).sqrt(), mean(self.after).sqrt());
        // Without neighbours, the remaining residuals are the only estimate of the noise.
        let noise =
            if self.pairs > 0.0 { (self.steps / self.pairs + mean(self.poses)).sqrt() } else { after };
        ChannelGap { before, after, floor: noise.min(after) }
    }
}

/// Variance of a measurement due to the pose's errors, from its gradient and the standard deviations of the pose.
fn pose_variance(gradient: &Vector6<f64>, sigmas: &[f64; 6]) -> f64 {
    gradient.iter().zip(sigmas).map(|(gradient, sigma)| (gradient * sigma).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_noise_floor_is_the_scatter_of_neighbours_together_with_that_of_pose_errors() {
        let squares = Squares { before: 40.0, after: 36.0, count: 4.0, poses: 16.0, steps: 10.0, pairs: 2.0 };
        let gap = squares.gap();
        assert_eq!((gap.before, gap.after, gap.floor), (10.0_f64.sqrt(), 3.0, 3.0));
        let quiet = Squares { steps: 2.0, poses: 0.0, ..squares }.gap();
        assert_eq!(quiet.floor, 1.0);
    }
}
