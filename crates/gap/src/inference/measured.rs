//! A recording measured where a model expects things, with the normal equations of the frames that are fitted.

use reality_sim_sensor::Model;

use crate::{
    inference::effect_test::{EffectTests, base},
    inference::evidence::Evidence,
    inference::split::HeldOutSplit,
    linear_model::linearization::{MeasureError, linearise, measure_frames},
    linear_model::nuisance::{Nuisance, tolerances},
    linear_model::parameters::FittedParameter,
    linear_model::system::{LinearSystem, LinearizedFrame},
    measurement::frame::FrameMeasurements,
    measurement::quantity::Channel,
    recording::Recording,
};

/// How far from where they are expected lines are looked for at first and once a model has been moved, as a part of
/// the picture's width.
pub(crate) const SEARCH: [f64; 2] = [0.028, 0.014];

/// A recording measured where a model expects things.
#[derive(Debug, Clone)]
pub(crate) struct LinearizedRecording {
    pub(crate) model: Model,
    pub(crate) looks: Vec<FrameMeasurements>,
    pub(crate) tolerances: Vec<Nuisance>,
    pub(crate) frames: Vec<LinearizedFrame>,
    pub(crate) system: LinearSystem,
}

impl LinearizedRecording {
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
        // A step of the odometry to a frame that is kept for judging is not fitted.
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

    /// What speaks for each effect, seen from where the model is.
    pub(crate) fn naming<'a>(&'a self, columns: &'a [FittedParameter]) -> EffectTests<'a> {
        EffectTests { evidence: Evidence::new(&self.system, base(columns, &self.model)), columns }
    }
}
