//! Comparison of one recording, with one or many settings.

use std::ops::Range;

use reality_sim_core::{localization::LocalizerConfig, observation::ObservationKind, sequence::Sequence};
use reality_sim_gap::{Analysis, Options, Pictures, Recording, analyse, html};
use reality_sim_pipeline::{FilterPlan, PoseChoice};
use reality_sim_sensor::{Chain, Model, library};

use super::{ComparisonError, ComparisonSettings, ReferencePoses};

/// Recording that has been compared with a model of its camera.
#[derive(Debug)]
pub struct Comparison {
    /// What was found.
    pub analysis: Analysis,
    /// Effects that the settings gave.
    pub given: Model,
    /// Poses at which they were compared.
    pub poses: ReferencePoses,
    frames: Option<Range<usize>>,
}

/// Compares a recording with a model of its camera, on the processor.
pub fn compare(sequence: &Sequence, settings: &ComparisonSettings) -> Result<Comparison, ComparisonError> {
    let given = settings.given(sequence)?;
    let frames = settings.frames.map(|[from, to]| from..to);
    // Before the filter fails for want of them.
    Recording::check_pictures(sequence, frames.clone())?;
    let poses = ReferencePoses::find(sequence, settings.pose_choice(), settings.filter(), |_| {
        Ok::<(), ComparisonError>(())
    })?;
    let recording = Recording::new(sequence, &poses.poses, poses.source, frames.clone())?;
    let options = Options { seed: settings.seed, without: settings.without.clone() };
    let analysis = analyse(&recording, &given, &options, &|_| ())?;
    Ok(Comparison { analysis, given, poses, frames })
}

impl Comparison {
    /// Returns the report as an HTML page with pictures of the recording that was compared.
    pub fn page(&self, sequence: &Sequence) -> Result<String, ComparisonError> {
        let recording = Recording::new(sequence, &self.poses.poses, self.poses.source, self.frames.clone())?;
        let pictures = Pictures::new(&recording, &self.given, &self.analysis)?;
        Ok(html::page(&self.analysis.report, &pictures))
    }
}

impl ComparisonSettings {
    /// Reads the model of the settings; an empty one without.
    fn given(&self, sequence: &Sequence) -> Result<Model, ComparisonError> {
        let model = self.model.as_deref().map_or_else(|| Ok(Model::default()), Model::read)?;
        if let Some(path) = &self.model {
            Chain::new(&sequence.setup, &sequence.field, &model).map_err(|error| error.in_file(path))?;
        }
        let known = || library().iter().map(|effect| effect.id());
        if let Some(id) = self.without.iter().find(|id| !known().any(|known| known == id.as_str())) {
            return Err(ComparisonError::NoSuchEffect { id: id.clone(), known: known().collect() });
        }
        match self.without.iter().find(|id| model.values(id).is_some()) {
            Some(id) => Err(ComparisonError::HeldEffect { id: id.clone() }),
            None => Ok(model),
        }
    }

    fn pose_choice(&self) -> PoseChoice {
        match &self.poses {
            Some(file) => PoseChoice::File(file.clone()),
            None if self.tag => PoseChoice::Filter,
            None => PoseChoice::ReferenceElseFilter,
        }
    }

    fn filter(&self) -> FilterPlan {
        FilterPlan::default()
            .with_config(LocalizerConfig::new(ObservationKind::Contrast).with_seed(self.seed))
            .with_program(concat!("reality-sim ", env!("CARGO_PKG_VERSION")))
    }
}
