//! Recording measured and linearised at a model, with the normal equations of the training frames.

use reality_sim_sensor::{Effect, Model};

use crate::{
    frame_index::{PerFrame, ViewIndex},
    inference::effect_fit::{EffectFits, base},
    inference::effect_test::EffectTests,
    inference::evidence::Evidence,
    inference::held_out::Comparison,
    inference::split::HeldOutSplit,
    linear_model::initial_values::starting_values,
    linear_model::linearization::{MeasureError, linearise, measure_chosen, measure_frames},
    linear_model::nuisance::{Nuisance, nuisances},
    linear_model::parameters::FittedParameter,
    linear_model::{linearized_frame::LinearizedFrame, system::LinearSystem},
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
        let measurements = measure_frames(recording, &model, search_px(recording, search))?;
        let nuisances = nuisances(measurements.as_slice());
        let mut frames = linearise(recording, &measurements, &model, columns, &nuisances)?;
        // An odometry step that ends at a held-out frame is not fitted.
        for frame in split.training().filter(|frame| split.is_held_out(frame.next())) {
            frames[frame].leave_out(Channel::Motion);
        }
        let training: Vec<&LinearizedFrame> = split.training().map(|frame| &frames[frame]).collect();
        let views = recording.views();
        let views: Vec<ViewIndex> = split.training().map(|frame| views[frame]).collect();
        let size = columns.len() + nuisances.len();
        let system = LinearSystem::new(&training, size, recording.reference(), &views);
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

    /// Compares a model with that of a linearised recording on held-out frames.
    fn compare(&self, model: &Model, with: &LinearizedRecording) -> Result<Comparison, MeasureError>;
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

    fn compare(&self, model: &Model, with: &LinearizedRecording) -> Result<Comparison, MeasureError> {
        // Lines are measured where the second model expects them and, if it finds none there, where the first one does.
        let mut measurements = with.measurements.clone();
        if *model != with.model {
            let search_px = search_px(self.recording, Thresholds::DEFAULT.inference.search_again);
            let is_held_out = |frame| self.split.is_held_out(frame);
            let others = measure_chosen(self.recording, model, search_px, is_held_out)?;
            let both = measurements.iter().zip(&others).map(|(own, other)| own.clone().with_lines_of(other));
            measurements = both.collect();
        }
        let linearise_at =
            |model: &Model| linearise(self.recording, &measurements, model, &[], &with.nuisances);
        let [before, after] = [linearise_at(model)?, linearise_at(&with.model)?];
        let lost = |frame| measurements[frame].lost_lines() as f64;
        Ok(Comparison::new([&before, &after], lost, with, self.split))
    }
}

/// Returns a part of the picture's width, pixels.
fn search_px(recording: &Recording<'_>, part: f64) -> f64 {
    part * f64::from(recording.sequence.setup.camera.width)
}
