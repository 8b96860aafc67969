//! Residuals on held-out frames, and the gap of two models there, on the same measurements, beside the noise floor.

use std::collections::BTreeMap;

use nalgebra::{DVector, Vector6};
use reality_sim_sensor::Model;

use crate::{
    frame_index::{FrameIndex, PerFrame},
    inference::linearized_recording::LinearizedRecording,
    inference::selected_model::SelectedModel,
    inference::shown_brightness::at_shown_brightness,
    inference::split::HeldOutSplit,
    linear_model::linearization::{MeasureError, linearise},
    linear_model::{
        fitted_residuals::FittedResiduals,
        linearized_frame::LinearizedFrame,
        robust_weights::{sigmas_by_quantity, weigh_by_scale},
        system::LinearSystem,
    },
    measurement::quantity::{Channel, Quantity},
    recording::Recording,
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;
const REFITTING_ROUNDS: usize = Thresholds::DEFAULT.linear_model.refitting_rounds;

/// Residuals of all frames under a model.
pub(crate) struct HeldOutResiduals {
    /// Residuals at the reference poses and nominal values, by frame and measurement: the errors of a simulator that is
    /// given these poses.
    pub(crate) residuals: PerFrame<Vec<f64>>,
}

impl HeldOutResiduals {
    /// Computes residuals under `model` of the measurements that were made with the extended model.
    pub(crate) fn new(
        recording: &Recording<'_>,
        found: &SelectedModel,
        model: &Model,
    ) -> Result<Self, MeasureError> {
        let linearized = &found.linearized;
        let frames = linearise(recording, &linearized.measurements, model, &[], linearized.others())?;
        let fitted = (&linearized.system, &found.split);
        let frames = at_shown_brightness(recording, frames, linearized.nuisances.len(), fitted);
        Ok(Self { residuals: frames.iter().map(|frame| at_reference(frame, linearized)).collect() })
    }
}

/// Returns a frame's residuals at its reference pose and nominal values.
fn at_reference(frame: &LinearizedFrame, linearized: &LinearizedRecording) -> Vec<f64> {
    let nowhere = DVector::zeros(linearized.system.columns.len());
    at_pose(frame, &linearized.system, &nowhere).residuals
}

/// Returns a frame's residuals after a change of the columns, with the pose as it is: no measurement counts for it.
fn at_pose(frame: &LinearizedFrame, system: &LinearSystem, delta: &DVector<f64>) -> FittedResiduals {
    let unweighted = vec![0.0; frame.residuals.len()];
    FittedResiduals::new(frame, &unweighted, delta, &system.columns, &system.pose_sigmas)
}

/// Returns a frame's residuals after a change of the columns, with the pose refitted.
///
/// What is an outlier is judged anew in every round, first by the scatter of the frame's own residuals: at the reference pose
/// most lines may be farther off than the noise of lines at the fitted one.
pub(crate) fn refitted(
    frame: &LinearizedFrame,
    system: &LinearSystem,
    delta: &DVector<f64>,
) -> FittedResiduals {
    let mut fitted = at_pose(frame, system, delta);
    for _ in 0..REFITTING_ROUNDS {
        let mut scales = sigmas_by_quantity(frame.measurements.iter().zip(fitted.residuals.iter().copied()));
        for (quantity, scale) in &mut scales {
            *scale = scale.max(system.sigmas.get(quantity).copied().unwrap_or(0.0));
        }
        let weights = weigh_by_scale(frame, &fitted.residuals, &system.sigmas, &scales);
        fitted = FittedResiduals::new(frame, &weights, delta, &system.columns, &system.pose_sigmas);
    }
    fitted
}

/// Root mean squares of one channel's residuals, in the channel's unit.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ChannelGap {
    /// Size with the model as it was given.
    pub before: f64,
    /// Size with the extended model.
    pub after: f64,
    /// Noise floor, from differences of neighbouring measurements in one picture or of successive odometry steps. The size with
    /// the extended model may be smaller by chance.
    pub floor: f64,
    /// Share of the measurements that neither model explains, and which are left out of all sizes: other things than lines
    /// and carpet, and lines that neither model finds. 0 to 1.
    pub left_out: f64,
}

impl ChannelGap {
    /// Whether the added effects change the size.
    pub fn has_moved(&self) -> bool {
        has_moved(self.before, self.after)
    }

    /// Whether the added effects make the size larger, by more than measuring the lines anew can.
    pub fn has_grown(&self) -> bool {
        self.after > self.before && self.has_moved()
    }
}

/// Whether a gap has changed by more than measuring the lines anew can change it.
pub(crate) fn has_moved(before: f64, after: f64) -> bool {
    (before - after).abs() > THRESHOLDS.least_gap_change * before
}

/// Sizes of two models' residuals on held-out frames, at the reference poses and nominal values.
///
/// Both models count the same measurements: those that either of them explains, with the pose refitted within its errors. A
/// line that only one of them finds counts for the other one by how far off it predicts it.
pub(crate) struct Comparison {
    channels: BTreeMap<Channel, Squares>,
}

impl Comparison {
    /// Compares the residuals of a first model with those of a second one, at which the recording was linearised. `frames` are
    /// those of both, with the same measurements; `lost` is the number of lines in each that neither model finds.
    pub(crate) fn new(
        frames: [&PerFrame<LinearizedFrame>; 2],
        lost: impl Fn(FrameIndex) -> f64,
        linearized: &LinearizedRecording,
        split: &HeldOutSplit,
    ) -> Self {
        let mut channels: BTreeMap<Channel, Squares> = BTreeMap::new();
        let mut last: BTreeMap<Quantity, f64> = BTreeMap::new();
        let mut next: Option<FrameIndex> = None;
        for frame in split.held_out() {
            // Neighbours are measurements in one picture; for the odometry they are successive steps.
            last.retain(|quantity, _| quantity.is_proprioceptive() && Some(frame) == next);
            next = Some(frame.next());
            let rows = Rows::new(frames.map(|frames| &frames[frame]), linearized);
            rows.add_to(&mut channels, &mut last);
            channels.entry(Channel::Geometry).or_default().left_out += lost(frame);
        }
        channels.retain(|_, squares| squares.count > 0.0);
        Self { channels }
    }

    /// Returns the gap of every measured channel.
    pub(crate) fn gaps(&self) -> BTreeMap<Channel, ChannelGap> {
        self.channels.iter().map(|(channel, squares)| (*channel, squares.gap())).collect()
    }

    /// Returns the channels whose predictions differ most between the two models, in their noise floors.
    pub(crate) fn claimed(&self) -> Vec<Channel> {
        let changes: Vec<(Channel, f64)> =
            self.channels.iter().map(|(channel, squares)| (*channel, squares.relative_change())).collect();
        let most = changes.iter().map(|(_, change)| *change).fold(0.0, f64::max);
        let is_claimed = |(_, change): &&(Channel, f64)| *change > THRESHOLDS.claimed_share * most;
        changes.iter().filter(is_claimed).map(|(channel, _)| *channel).collect()
    }

    /// Returns the gaps over these channels together, of the first model and of the second, in noise floors.
    pub(crate) fn whole(&self, channels: &[Channel]) -> [f64; 2] {
        let gaps: Vec<ChannelGap> =
            channels.iter().filter_map(|channel| Some(self.channels.get(channel)?.gap())).collect();
        let mean = |size: fn(&ChannelGap) -> f64| {
            let squares = gaps.iter().map(|gap| (size(gap) / gap.floor.max(1e-9)).powi(2));
            (squares.sum::<f64>() / gaps.len().max(1) as f64).sqrt()
        };
        [mean(|gap| gap.before), mean(|gap| gap.after)]
    }
}

/// Residuals of one held-out frame under two models, row by row.
struct Rows<'a> {
    frames: [&'a LinearizedFrame; 2],
    linearized: &'a LinearizedRecording,
    /// Residuals at the reference pose.
    residuals: [Vec<f64>; 2],
    /// Residuals with the pose refitted.
    refitted: [Vec<f64>; 2],
    /// Error of the pose by the second model.
    pose_error: Vector6<f64>,
}

impl<'a> Rows<'a> {
    fn new(frames: [&'a LinearizedFrame; 2], linearized: &'a LinearizedRecording) -> Self {
        let system = &linearized.system;
        let nowhere = DVector::zeros(system.columns.len());
        let [before, after] = frames.map(|frame| refitted(frame, system, &nowhere));
        Self {
            frames,
            linearized,
            residuals: frames.map(|frame| at_reference(frame, linearized)),
            pose_error: after.pose_error,
            refitted: [before.residuals, after.residuals],
        }
    }

    /// Adds the squares of the rows that count. `last` are the preceding residuals of each quantity.
    fn add_to(&self, channels: &mut BTreeMap<Channel, Squares>, last: &mut BTreeMap<Quantity, f64>) {
        let system = &self.linearized.system;
        for (index, measurement) in self.frames[1].measurements.iter().enumerate() {
            let [before, after] = [0, 1].map(|model| self.residuals[model][index]);
            if !before.is_finite() && !after.is_finite() {
                continue;
            }
            let sigma = system.sigmas.get(&measurement.quantity).copied().unwrap_or(0.0);
            let explains =
                |model: usize| self.refitted[model][index].abs() < THRESHOLDS.outlying_sigmas * sigma;
            let squares = channels.entry(measurement.quantity.channel()).or_default();
            if !(before.is_finite() && after.is_finite() && (explains(0) || explains(1))) {
                squares.left_out += 1.0;
                continue;
            }
            squares.before += before * before;
            squares.after += after * after;
            squares.change += (before - after).powi(2);
            squares.count += 1.0;
            squares.poses += self.frames[1].pose_gradients[index].dot(&self.pose_error).powi(2);
            if !explains(1) {
                continue;
            }
            let refitted = self.refitted[1][index];
            if let Some(previous) = last.insert(measurement.quantity, refitted) {
                squares.steps += 0.5 * (refitted - previous).powi(2);
                squares.pairs += 1.0;
            }
        }
    }
}

/// Sums of squares of a channel's residuals.
#[derive(Debug, Clone, Copy, Default)]
struct Squares {
    before: f64,
    after: f64,
    /// Sum of the squared differences between the two models' predictions.
    change: f64,
    /// Number of residuals.
    count: f64,
    /// Number of measurements that are left out.
    left_out: f64,
    /// Sum of squares of what the reference poses' errors make.
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
        let floor =
            if self.pairs > 0.0 { (self.steps / self.pairs + mean(self.poses)).sqrt() } else { after };
        let left_out = self.left_out / (self.left_out + self.count).max(1.0);
        ChannelGap { before, after, floor, left_out }
    }

    /// Returns the root mean square of the change in noise floors.
    fn relative_change(&self) -> f64 {
        (self.change / self.count.max(1.0)).sqrt() / self.gap().floor.max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        linear_model::column::ColumnIndex,
        measurement::scalar::Measurement,
        testing::{Noise, measurement, system_of},
    };

    const SIGMA: f64 = 0.1;
    const FRAMES: usize = 12;

    /// Returns frames with these residuals of lines' blurs in each.
    fn frames(residuals: &[f64]) -> PerFrame<LinearizedFrame> {
        let rows: Vec<Measurement> = residuals.iter().map(|_| measurement(Quantity::LineBlur)).collect();
        let frame = LinearizedFrame {
            pose_gradients: vec![Vector6::zeros(); rows.len()],
            jacobian: vec![Vec::<(ColumnIndex, f64)>::new(); rows.len()],
            patches: vec![None; rows.len()],
            residuals: residuals.to_vec(),
            measurements: rows,
        };
        PerFrame::from(vec![frame; FRAMES])
    }

    /// Compares the residuals of two models, of which the second one is the better.
    fn compared(before: &[f64], after: &[f64]) -> Comparison {
        let frames = [before, after].map(frames);
        let mut system = system_of(vec![(nalgebra::DMatrix::zeros(1, 1), DVector::zeros(1)); FRAMES]);
        system.sigmas = BTreeMap::from([(Quantity::LineBlur, SIGMA)]);
        let linearized = LinearizedRecording {
            model: Model::default(),
            measurements: PerFrame::from(Vec::new()),
            nuisances: Vec::new(),
            frames: frames[1].clone(),
            system,
        };
        Comparison::new([&frames[0], &frames[1]], |_| 0.0, &linearized, &HeldOutSplit::new(FRAMES, 0))
    }

    fn gap(before: &[f64], after: &[f64]) -> ChannelGap {
        compared(before, after).gaps().remove(&Channel::Sharpness).unwrap()
    }

    #[test]
    fn the_noise_floor_is_the_scatter_of_neighbours_together_with_that_of_pose_errors() {
        let squares = Squares {
            before: 40.0,
            after: 36.0,
            count: 4.0,
            poses: 16.0,
            steps: 10.0,
            pairs: 2.0,
            ..Squares::default()
        };
        let gap = squares.gap();
        assert_eq!((gap.before, gap.after, gap.floor), (10.0_f64.sqrt(), 3.0, 3.0));
        let quiet = Squares { steps: 2.0, poses: 0.0, ..squares }.gap();
        assert_eq!(quiet.floor, 1.0);
    }

    #[test]
    fn the_noise_floor_does_not_depend_on_what_is_left() {
        let noisy = Squares { after: 4.0, count: 4.0, steps: 10.0, pairs: 2.0, ..Squares::default() }.gap();
        assert_eq!((noisy.after, noisy.floor), (1.0, 5.0_f64.sqrt()));
    }

    #[test]
    fn a_measurement_that_only_the_first_model_explains_counts_for_both() {
        // The second model loses the last measurement, which the first one predicts well.
        let gap = gap(&[0.1, -0.1, 0.1, 0.0], &[0.0, 0.0, 0.0, 2.0]);
        assert!((gap.after - 1.0).abs() < 1e-12, "{gap:?}");
        assert!((gap.before - 0.1 * 0.75_f64.sqrt()).abs() < 1e-12, "{gap:?}");
        assert_eq!(gap.left_out, 0.0);
        assert!(gap.has_grown());
    }

    #[test]
    fn what_neither_model_explains_is_left_out_of_both_sizes_and_its_share_is_stated() {
        let gap = gap(&[0.1, -0.1, 0.1, 3.0], &[0.0, 0.0, 0.0, 2.0]);
        assert!((gap.before - 0.1).abs() < 1e-12 && gap.after == 0.0, "{gap:?}");
        assert_eq!(gap.left_out, 0.25);
    }

    #[test]
    fn lines_that_neither_model_finds_are_left_out_of_geometry() {
        let mut frames = frames(&[0.0]);
        for frame in FrameIndex::first(FRAMES) {
            frames[frame].measurements[0].quantity = Quantity::LineOffset;
        }
        let mut system = system_of(vec![(nalgebra::DMatrix::zeros(1, 1), DVector::zeros(1)); FRAMES]);
        system.sigmas = BTreeMap::from([(Quantity::LineOffset, SIGMA)]);
        let (measurements, nuisances) = (PerFrame::from(Vec::new()), Vec::new());
        let linearized = LinearizedRecording {
            model: Model::default(),
            measurements,
            nuisances,
            frames: frames.clone(),
            system,
        };
        let compared =
            Comparison::new([&frames, &frames], |_| 3.0, &linearized, &HeldOutSplit::new(FRAMES, 0));
        assert_eq!(compared.gaps()[&Channel::Geometry].left_out, 0.75);
    }

    #[test]
    fn an_effect_claims_the_channels_that_it_changes() {
        assert_eq!(compared(&[0.3, -0.3], &[0.0, 0.1]).claimed(), [Channel::Sharpness]);
        assert_eq!(compared(&[0.1, -0.1], &[0.1, -0.1]).claimed(), []);
    }

    #[test]
    fn poses_are_refitted_where_most_lines_are_off_at_first() {
        let mut noise = Noise(3);
        let pose_error = Vector6::from_fn(|_, _| 0.01 * noise.next());
        let lines = 60;
        let pose_gradients: Vec<Vector6<f64>> =
            (0..lines).map(|_| Vector6::from_fn(|_, _| 100.0 * noise.next())).collect();
        let mut of_line = |gradient: &Vector6<f64>| gradient.dot(&pose_error) + 0.1 * SIGMA * noise.next();
        let mut residuals: Vec<f64> = pose_gradients.iter().map(&mut of_line).collect();
        let outlying = THRESHOLDS.outlying_sigmas * SIGMA;
        let off_at_first = residuals.iter().filter(|residual| residual.abs() > outlying).count();
        assert!(off_at_first > lines / 2, "{off_at_first}");
        // Every fifth line is another thing.
        residuals.iter_mut().step_by(5).for_each(|residual| *residual += 20.0);
        let frame = LinearizedFrame {
            measurements: residuals.iter().map(|_| measurement(Quantity::LineOffset)).collect(),
            jacobian: vec![Vec::<(ColumnIndex, f64)>::new(); lines],
            patches: vec![None; lines],
            residuals,
            pose_gradients,
        };
        let mut system = system_of(vec![(nalgebra::DMatrix::zeros(1, 1), DVector::zeros(1)); FRAMES]);
        system.sigmas = BTreeMap::from([(Quantity::LineOffset, SIGMA)]);
        system.pose_sigmas = [0.02; 6];
        let fitted = refitted(&frame, &system, &DVector::zeros(1));
        let explained = fitted.residuals.iter().filter(|residual| residual.abs() < outlying).count();
        assert_eq!(explained, lines - lines / 5);
        assert!((fitted.pose_error - pose_error).norm() < 0.1 * pose_error.norm(), "{}", fitted.pose_error);
    }
}
