//! A recording measured where a model expects things, with the normal equations of the frames that are fitted.

use reality_sim_sensor::Model;

use crate::{
    columns::Column,
    evidence::Evidence,
    look::Look,
    measure::{MeasureError, linearise, look_at},
    naming::{Naming, base},
    recording::Recording,
    rows::Channel,
    split::Split,
    system::{FrameRows, System},
    tolerance::{Tolerance, tolerances},
};

/// How far from where they are expected lines are looked for at first and once a model has been moved, as a part of
/// the picture's width.
pub(crate) const SEARCH: [f64; 2] = [0.028, 0.014];

/// A recording measured where a model expects things.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    pub(crate) model: Model,
    pub(crate) looks: Vec<Look>,
    pub(crate) tolerances: Vec<Tolerance>,
    pub(crate) frames: Vec<FrameRows>,
    pub(crate) system: System,
}

impl Measured {
    pub(crate) fn new(
        recording: &Recording<'_>,
        model: Model,
        columns: &[Column],
        split: &Split,
        search: f64,
    ) -> Result<Self, MeasureError> {
        let search_px = search * f64::from(recording.sequence.setup.camera.width);
        let looks = look_at(recording, &model, search_px)?;
        let tolerances = tolerances(&looks);
        let mut frames = linearise(recording, &looks, &model, columns, &tolerances)?;
        // A step of the odometry to a frame that is kept for judging is not fitted.
        for frame in split.fitted().filter(|frame| split.is_judged(frame + 1)) {
            frames[frame].leave_out(Channel::Motion);
        }
        let fitted: Vec<&FrameRows> = split.fitted().map(|frame| &frames[frame]).collect();
        let views = recording.views();
        let views: Vec<usize> = split.fitted().map(|frame| views[frame]).collect();
        let size = columns.len() + tolerances.len();
        let system = System::new(&fitted, size, recording.reference(), &views);
        Ok(Self { model, looks, tolerances, frames, system })
    }

    /// What speaks for each effect, seen from where the model is.
    pub(crate) fn naming<'a>(&'a self, columns: &'a [Column]) -> Naming<'a> {
        Naming { evidence: Evidence::new(&self.system, base(columns, &self.model)), columns }
    }
}
