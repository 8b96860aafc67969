//! Recording measured and linearised at a model, with the normal equations of the training frames.

use reality_sim_core::sequence::Photometry;
use reality_sim_sensor::{Chain, Model};

use crate::{
    frame_index::{PerFrame, ViewIndex},
    inference::effect_fit::{EffectFits, base},
    inference::effect_test::EffectTests,
    inference::evidence::Evidence,
    inference::split::HeldOutSplit,
    linear_model::column::Columns,
    linear_model::linearization::{MeasureError, Others, linearise, measure_frames, measured_patches},
    linear_model::mean_reflectance::MeanReflectance,
    linear_model::nuisance::{Nuisance, nuisances},
    linear_model::parameters::FittedParameter,
    linear_model::reflectance::ReflectanceField,
    linear_model::texture::CarpetTexture,
    linear_model::{
        linearized_frame::LinearizedFrame,
        reference_drift::ReferenceDrift,
        system::{LinearSystem, Weighting},
    },
    measurement::frame::FrameMeasurements,
    measurement::quantity::Channel,
    recording::Recording,
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
        let setup = &recording.sequence.setup;
        let chain = Chain::new(setup, &recording.sequence.field, &model)?;
        let mut nuisances = nuisances(
            &MeanReflectance::new(recording, &measurements, &chain),
            &CarpetTexture::new(&measurements, &chain, recording.gamma()),
            &setup.photometry.unwrap_or(Photometry::of_gamma(recording.gamma())),
        );
        let sigma_s = chain.clock_s().abs();
        let clocks = [Nuisance::OdometryClock { sigma_s }, Nuisance::AttitudeClock { sigma_s }];
        nuisances.extend(clocks.into_iter().filter(|_| sigma_s > 0.0));
        let patches = measured_patches(&measurements);
        let others = Others { nuisances: &nuisances, patches: &patches };
        let mut frames = linearise(recording, &measurements, &model, columns, others)?;
        // An odometry step that ends at a held-out frame is not fitted.
        for frame in split.training().filter(|frame| split.is_held_out(frame.next())) {
            frames[frame].leave_out(Channel::Motion);
        }
        let views = recording.views();
        let views: Vec<ViewIndex> = split.training().map(|frame| views[frame]).collect();
        let all = Columns {
            parameters: columns.len(),
            nuisances: nuisances.len(),
            field: ReflectanceField::new(patches),
        };
        let times_s: Vec<f64> = split.training().map(|frame| recording.frames[frame].time_s).collect();
        let reference = recording.reference();
        let (weighting, fits) = Weighting::estimate(&training(&frames, split), &all, reference);
        let drift = ReferenceDrift::new(reference, &times_s, &fits, weighting.pose_sigmas);
        for (index, frame) in recording.frames.indexed() {
            let yaw_rad = recording.trajectory.at(frame.time_s).yaw_rad;
            drift.add_to(&mut frames[index], frame.time_s, yaw_rad, all.dense());
        }
        let all = Columns { nuisances: all.nuisances + drift.len(), ..all };
        let training = training(&frames, split);
        let (weighting, _) = weighting.refine(&training, &all, reference);
        let mut system = LinearSystem::new(&training, all, &weighting, &views);
        system.pose_sigmas = drift.together_with(system.pose_sigmas);
        Ok(Self { model, measurements, nuisances, frames, system })
    }

    /// Returns the parameters beside those of effects.
    pub(crate) fn others(&self) -> Others<'_> {
        Others { nuisances: &self.nuisances, patches: &self.system.columns.field.tree }
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

/// Returns a part of the picture's width, pixels.
pub(crate) fn search_px(recording: &Recording<'_>, part: f64) -> f64 {
    part * f64::from(recording.sequence.setup.camera.width)
}

/// Returns the frames that are fitted.
fn training<'a>(frames: &'a PerFrame<LinearizedFrame>, split: &HeldOutSplit) -> Vec<&'a LinearizedFrame> {
    split.training().map(|frame| &frames[frame]).collect()
}
