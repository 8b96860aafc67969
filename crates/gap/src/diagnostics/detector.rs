//! What detectors look at, and what they have in common.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::{
    diagnostics::finding::Finding,
    inference::held_out::ChannelGap,
    inference::model_error::ModelError,
    linear_model::nuisance::Nuisance,
    measurement::frame::FrameMeasurements,
    measurement::quantity::{Channel, Quantity},
    measurement::scalar::Measurement,
    recording::{Frame, Recording},
    thresholds::Thresholds,
};

/// Largest p-value of a finding, corrected for everything that is tested of its kind.
pub(crate) const SIGNIFICANCE: f64 = Thresholds::DEFAULT.diagnostics.significance;

/// Finds one kind of thing that no effect of the library explains.
pub(crate) trait Detector: Sync {
    /// Returns what is significant in what a fit left.
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding>;
}

/// What the effects of a model leave of a recording, with nuisance parameters and poses fitted. Frames are those that were
/// fitted.
pub(crate) struct FitResiduals<'a> {
    pub(crate) recording: &'a Recording<'a>,
    /// Time of the recording's first frame, seconds.
    pub(crate) start_s: f64,
    pub(crate) frames: Vec<FrameResiduals<'a>>,
    /// The frames' times and odometry, in the same order.
    pub(crate) steps: Vec<&'a Frame>,
    /// What was measured in the frames, in the same order.
    pub(crate) measurements: Vec<&'a FrameMeasurements>,
    /// Standard deviations of the residuals.
    pub(crate) sigmas: &'a BTreeMap<Quantity, f64>,
    pub(crate) nuisances: &'a [Nuisance],
    /// Fitted values of the nuisance parameters, in their standard deviations.
    pub(crate) nuisance_values: &'a [f64],
    /// How far the model may be off beside what it explains.
    pub(crate) model_error: &'a ModelError,
    /// Gaps of the channels, on held-out frames.
    pub(crate) gaps: &'a BTreeMap<Channel, ChannelGap>,
}

/// A frame's residuals after the fit.
pub(crate) struct FrameResiduals<'a> {
    pub(crate) measurements: &'a [Measurement],
    /// One residual for each measurement.
    pub(crate) values: Vec<f64>,
    pub(crate) time_s: f64,
    /// Point on the field below the camera, metres.
    pub(crate) camera: DVec2,
    /// Width and height of the picture, pixels.
    pub(crate) size: [u32; 2],
}
