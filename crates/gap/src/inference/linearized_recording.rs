//! Recording measured and linearised at a model, with the normal equations of the training frames.

use reality_sim_sensor::{Effect, Model};

use crate::{
    frame_index::{PerFrame, ViewIndex},
    inference::effect_fit::{EffectFits, base},
    inference::effect_test::EffectTests,
    inference::evidence::Evidence,
    inference::split::HeldOutSplit,
    linear_model::initial_values::starting_values,
    linear_model::linearization::{MeasureError, linearise, measure_frames},
    linear_model::nuisance::{Nuisance, nuisances},
    linear_model::parameters::FittedParameter,
    linear_model::{
        linearized_frame::LinearizedFrame, reference_drift::ReferenceDrift, system::LinearSystem,
    },
    measurement::frame::FrameMeasurements,
    measurement::quantity::Channel,
    recording::Recording,
    thresholds::Thresholds,
};

/// Recording measured at the lines and the carpet that a model predicts, with the model's linearisation there.
#[derive(Debug, Clone)]
pub(crate) struct LinearizedRecording {
    pub(crate) model: Model,
    /// What was measured in each picture.
    pub(crate) measurements: PerFrame<FrameMeasurements>,
    /// Nuisance parameters, in the order of their columns.
    pub(crate) nuisances: Vec<Nuisance>,
    /// Residuals of each frame with their derivatives.
    pub(crate) frames: PerFrame<LinearizedFrame>,
    /// Normal equations of the training frames.
    pub(crate) system: LinearSystem,
}

impl LinearizedRecording {
    /// Measures and linearises a recording. Lines are searched for within `search` of where they are expected, a fraction
    /// of the picture's width.
    pub(crate) fn new(
        recording: &Recording<'_>,
        model: Model,
        columns: &[FittedParameter],
        split: &HeldOutSplit,
        search: f64,
    ) -> Result<Self, MeasureError> {
        let search_px = search * f64::from(recording.sequence.setup.camera.width);
        let measurements = measure_frames(recording, &model, search_px)?;
        Self::of_measurements(recording, model, measurements, columns, split)
    }

    /// Linearises the recording again, with the same measurements.
    pub(crate) fn again(
        self,
        recording: &Recording<'_>,
        columns: &[FittedParameter],
        split: &HeldOutSplit,
    ) -> Result<Self, MeasureError> {
        Self::of_measurements(recording, self.model, self.measurements, columns, split)
    }

    fn of_measurements(
        recording: &Recording<'_>,
        model: Model,
        measurements: PerFrame<FrameMeasurements>,
        columns: &[FittedParameter],
        split: &HeldOutSplit,
    ) -> Result<Self, MeasureError> {
        let nuisances = nuisances(measurements.as_slice());
        let mut frames = linearise(recording, &measurements, &model, columns, &nuisances)?;
        // An odometry step that ends at a held-out frame is not fitted.
        for frame in split.training().filter(|frame| split.is_held_out(frame.next())) {
            frames[frame].leave_out(Channel::Motion);
        }
        let views = recording.views();
        let views: Vec<ViewIndex> = split.training().map(|frame| views[frame]).collect();
        let system = |frames: &PerFrame<LinearizedFrame>, size: usize| {
            let training: Vec<&LinearizedFrame> = split.training().map(|frame| &frames[frame]).collect();
            LinearSystem::new(&training, size, recording.reference(), &views)
        };
        let size = columns.len() + nuisances.len();
        let drift = {
            let times_s: Vec<f64> = split.training().map(|frame| recording.frames[frame].time_s).collect();
            let training: Vec<&LinearizedFrame> = split.training().map(|frame| &frames[frame]).collect();
            ReferenceDrift::new(recording.reference(), &times_s, &training, &system(&frames, size))
        };
        for (index, frame) in recording.frames.indexed() {
            drift.add_to(
                &mut frames[index],
                frame.time_s,
                recording.trajectory.at(frame.time_s).yaw_rad,
                size,
            );
        }
        let mut system = system(&frames, size + drift.len());
        system.pose_sigmas = drift.together_with(system.pose_sigmas);
        Ok(Self { model, measurements, nuisances, frames, system })
    }

    /// Returns the fits of effects at the present model.
    pub(crate) fn effect_fits<'a>(&'a self, columns: &'a [FittedParameter]) -> EffectFits<'a> {
        EffectFits { evidence: Evidence::new(&self.system, base(columns, &self.model)), columns }
    }

    /// Returns the tests of effects at the present model.
    pub(crate) fn effect_tests<'a>(&'a self, columns: &'a [FittedParameter]) -> EffectTests<'a> {
        EffectTests::new(self.effect_fits(columns))
    }
}

/// Source of linearised recordings, which are measured anew at each model.
pub(crate) trait Linearize {
    /// Measures and linearises the recording at a model.
    fn linearize(&self, model: Model) -> Result<LinearizedRecording, MeasureError>;

    /// Returns the starting values of an effect that is not in the model yet.
    fn starting_values(&self, effect: &'static dyn Effect) -> Vec<f64>;
}

/// Recording with the parameters that are fitted to it. Lines are searched for near where a model expects them.
pub(crate) struct FittedRecording<'a> {
    pub(crate) recording: &'a Recording<'a>,
    pub(crate) columns: &'a [FittedParameter],
    pub(crate) split: &'a HeldOutSplit,
}

impl Linearize for FittedRecording<'_> {
    fn linearize(&self, model: Model) -> Result<LinearizedRecording, MeasureError> {
        let search = Thresholds::DEFAULT.inference.search_again;
        LinearizedRecording::new(self.recording, model, self.columns, self.split, search)
    }

    fn starting_values(&self, effect: &'static dyn Effect) -> Vec<f64> {
        starting_values(effect, self.recording)
    }
}
