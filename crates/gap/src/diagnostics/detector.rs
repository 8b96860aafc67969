//! Interface of the detectors, and the residuals that they examine.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::{
    diagnostics::finding::Finding,
    inference::held_out::ChannelGap,
    inference::light_pattern::LightPattern,
    inference::model_error::ModelError,
    linear_model::nuisance::Nuisance,
    measurement::frame::FrameMeasurements,
    measurement::quantity::{Channel, Quantity},
    measurement::scalar::Measurement,
    recording::{Frame, Recording, ReferenceSource},
    thresholds::Thresholds,
};

/// Largest p-value of a finding, corrected for all tests of its kind.
pub(crate) const SIGNIFICANCE: f64 = Thresholds::DEFAULT.diagnostics.significance;

/// Detector of one kind of deviation that no effect of the library explains.
pub(crate) trait Detector: Sync {
    /// Returns the significant deviations in the residuals of a fit.
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding>;
}

/// Residuals of the training frames, with the effects of a model, the nuisance parameters and the poses fitted.
pub(crate) struct FitResiduals<'a> {
    pub(crate) recording: &'a Recording<'a>,
    /// Time of the recording's first frame, seconds.
    pub(crate) start_s: f64,
    pub(crate) frames: Vec<FrameResiduals<'a>>,
    /// Times and odometry of the frames, in the same order.
    pub(crate) steps: Vec<&'a Frame>,
    /// Measurements in the pictures of the frames, in the same order.
    pub(crate) measurements: Vec<&'a FrameMeasurements>,
    /// Standard deviation of the residuals of each quantity, in its unit.
    pub(crate) sigmas: &'a BTreeMap<Quantity, f64>,
    pub(crate) nuisances: &'a [Nuisance],
    /// Fitted values of the nuisance parameters, in their standard deviations.
    pub(crate) nuisance_values: &'a [f64],
    /// Error that the model is allowed to have: a fraction of what its effects explain.
    pub(crate) model_error: &'a ModelError,
    /// Most significant pattern of light, beside the reflectance of all places.
    pub(crate) light: Option<LightPattern>,
    /// Gap of each channel that is left on held-out frames, of the measurements that the extended model explains: those that
    /// the model as given explains, too, may be of other lines.
    pub(crate) left: &'a BTreeMap<Channel, ChannelGap>,
}

impl FitResiduals<'_> {
    /// Returns the gap that is left of the lines' positions. None at poses estimated from the pictures, which scatter themselves
    /// and of which some may be lost.
    pub(crate) fn geometry_at_measured_poses(&self) -> Option<&ChannelGap> {
        match self.recording.source {
            ReferenceSource::Measured => self.left.get(&Channel::Geometry),
            ReferenceSource::Tagged => None,
        }
    }
}

/// Residuals of a frame after the fit.
pub(crate) struct FrameResiduals<'a> {
    pub(crate) measurements: &'a [Measurement],
    /// Residual of each measurement, in the unit of its quantity; NaN if it does not count.
    pub(crate) values: Vec<f64>,
    pub(crate) time_s: f64,
    /// Point on the field below the camera, world axes, metres.
    pub(crate) camera: DVec2,
    /// Width and height of the picture, pixels.
    pub(crate) size: [u32; 2],
}
