//! Recording measured and linearised at a model, with the normal equations of the training frames.

use reality_sim_sensor::{Effect, Model};

use crate::{
    inference::effect_test::{EffectTests, base},
    inference::evidence::Evidence,
    inference::split::HeldOutSplit,
    linear_model::initial_values::starting_values,
    linear_model::linearization::{MeasureError, linearise, measure_frames},
    linear_model::nuisance::{Nuisance, tolerances},
    linear_model::parameters::FittedParameter,
    linear_model::{linearized_frame::LinearizedFrame, system::LinearSystem},
    measurement::frame::FrameMeasurements,
    measurement::quantity::Channel,
    recording::Recording,
    thresholds::Thresholds,
};

/// Recording measured where a model expects things, with the model's linearisation there.
#[derive(Debug, Clone)]
pub(crate) struct LinearizedRecording {
    pub(crate) model: Model,
    pub(crate) looks: Vec<FrameMeasurements>,
    pub(crate) tolerances: Vec<Nuisance>,
    pub(crate) frames: Vec<LinearizedFrame>,
    /// Normal equations of the training frames.
    pub(crate) system: LinearSystem,
}

impl LinearizedRecording {
    /// Measures and linearises a recording. Lines are searched for up to `search` from where they are expected, as a
    /// fraction of the picture's width.
    pub(crate) fn new(
        recording: &Recording<'_>,
        model: Model,
        columns: &[FittedParameter],
        split: &HeldOutSplit,
        search: f64,
    ) -> Result<Self, MeasureError> {
        let search_px = search * f64::from(recording.sequence.setup.camera.width);
        let looks = measure_frames(recording, &model, search_px)?;
        let tolerances = tolerances(&looks);
        let mut frames = linearise(recording, &looks, &model, columns, &tolerances)?;
        // An odometry step that ends at a held-out frame is not fitted.
        for frame in split.fitted().filter(|frame| split.is_judged(frame + 1)) {
            frames[frame].leave_out(Channel::Motion);
        }
        let fitted: Vec<&LinearizedFrame> = split.fitted().map(|frame| &frames[frame]).collect();
        let views = recording.views();
        let views: Vec<usize> = split.fitted().map(|frame| views[frame]).collect();
        let size = columns.len() + tolerances.len();
        let system = LinearSystem::new(&fitted, size, recording.reference(), &views);
        Ok(Self { model, looks, tolerances, frames, system })
    }

    /// Returns the effect tests at the present model.
    pub(crate) fn effect_tests<'a>(&'a self, columns: &'a [FittedParameter]) -> EffectTests<'a> {
        EffectTests { evidence: Evidence::new(&self.system, base(columns, &self.model)), columns }
    }
}

/// Source of linearised recordings, which are measured anew at each model.
pub(crate) trait Linearize {
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
