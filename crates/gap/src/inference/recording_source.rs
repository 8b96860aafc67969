//! Source of linearised recordings for a search: measures the recording anew at every model.

use reality_sim_sensor::{Effect, Model};

use crate::{
    inference::held_out::Comparison,
    inference::linearized_recording::{LinearizedRecording, search_px},
    inference::shown_brightness::at_shown_brightness,
    inference::split::HeldOutSplit,
    linear_model::initial_values::starting_values,
    linear_model::linearization::{MeasureError, linearise, measure_chosen},
    linear_model::parameters::FittedParameter,
    recording::Recording,
    thresholds::Thresholds,
};

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
        let linearise_at = |model: &Model| {
            let frames = linearise(self.recording, &measurements, model, &[], with.others())?;
            let fitted = (&with.system, self.split);
            Ok::<_, MeasureError>(at_shown_brightness(self.recording, frames, with.nuisances.len(), fitted))
        };
        let [before, after] = [linearise_at(model)?, linearise_at(&with.model)?];
        let lost = |frame| measurements[frame].lost_lines() as f64;
        Ok(Comparison::new([&before, &after], lost, with, self.split))
    }
}
