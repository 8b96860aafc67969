//! Recording that is localized with given settings and compared with its ground truth.

use std::{path::Path, sync::Arc};

use image::RgbImage;
use reality_sim::{
    Camera, FieldDimensions, Localizer, LocalizerConfig, Observation, Sequence,
    backend::{Backend, BackendError},
    evaluation::{PoseError, percentile},
    filter::{Filter, FilterConfig, ScoredFilter},
    observation::{NormalSearch, ObservationConfig},
};

/// Pictures of a sequence, decoded once for all runs.
pub struct Recording {
    pub sequence: Sequence,
    pub pictures: Vec<Arc<RgbImage>>,
}

/// Model that weights the particles.
#[derive(Clone, Copy)]
pub enum Model {
    /// Model of the settings.
    Configured,
    /// Eq. 1 exactly as in the paper.
    NormalSearch,
}

/// Backend that weights particles by Eq. 1 exactly as in the paper.
struct NormalSearchBackend;

impl Backend for NormalSearchBackend {
    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError> {
        let scorer = NormalSearch::new(camera, field, observation);
        Ok(Box::new(ScoredFilter::new(Box::new(scorer), config)))
    }
}

/// Result of one run over the recording.
pub struct Run {
    mean_m: f64,
    /// Mean error of the pictures that were not lost, metres.
    kept_m: f64,
    lost: usize,
    seconds_per_frame: f64,
}

/// Runs that differ only in the seed.
pub struct Runs(Vec<Run>);

impl Recording {
    pub fn open(folder: &Path, frames: usize) -> anyhow::Result<Self> {
        let mut sequence = Sequence::open(folder)?;
        sequence.frames.truncate(frames);
        let pictures = (0..sequence.frames.len())
            .map(|index| sequence.load_image(index).map(Arc::new))
            .collect::<Result<_, _>>()?;
        Ok(Self { sequence, pictures })
    }

    fn run(&self, config: LocalizerConfig, model: Model) -> anyhow::Result<Run> {
        let Sequence { setup, field, start, frames, .. } = &self.sequence;
        let camera = &setup.camera;
        let builder = Localizer::builder(camera, field).config(config).start(*start);
        let mut localizer = match model {
            Model::Configured => builder.build()?,
            Model::NormalSearch => builder.backend(Arc::new(NormalSearchBackend)).build()?,
        };
        let (mut errors, mut seconds) = (Vec::new(), Vec::new());
        for (index, picture) in self.pictures.iter().enumerate() {
            let frame = localizer.update(&Observation::of_frame(&self.sequence, index, picture))?;
            errors.extend(frames[index].reference_pose.map(|truth| PoseError::new(frame.pose, truth)));
            seconds.push(frame.seconds);
        }
        seconds.sort_by(f64::total_cmp);
        let kept: Vec<f64> =
            errors.iter().filter(|error| !error.is_lost()).map(|error| error.distance_m).collect();
        Ok(Run {
            mean_m: errors.iter().map(|error| error.distance_m).sum::<f64>() / errors.len().max(1) as f64,
            kept_m: kept.iter().sum::<f64>() / kept.len().max(1) as f64,
            lost: errors.iter().filter(|error| error.is_lost()).count(),
            seconds_per_frame: percentile(&seconds, 0.5).unwrap_or(0.0),
        })
    }

    pub fn runs(&self, seeds: u64, config: LocalizerConfig, model: Model) -> anyhow::Result<Runs> {
        let seeded = |seed| {
            let mut config = config;
            config.filter.seed = seed;
            self.run(config, model)
        };
        Ok(Runs((0..seeds.max(1)).map(seeded).collect::<Result<_, _>>()?))
    }
}

impl Runs {
    fn mean(&self, value: impl Fn(&Run) -> f64) -> f64 {
        self.0.iter().map(value).sum::<f64>() / self.0.len() as f64
    }

    pub fn mean_cm(&self) -> f64 {
        100.0 * self.mean(|run| run.mean_m)
    }

    /// Mean error of the pictures that were not lost, centimetres.
    pub fn kept_cm(&self) -> f64 {
        100.0 * self.mean(|run| run.kept_m)
    }

    /// Number of lost pictures over all seeds.
    pub fn lost_in_all(&self) -> usize {
        self.0.iter().map(|run| run.lost).sum()
    }

    /// Smallest and largest mean error of a run, centimetres.
    pub fn range_cm(&self) -> [f64; 2] {
        let means = || self.0.iter().map(|run| 100.0 * run.mean_m);
        [means().fold(f64::INFINITY, f64::min), means().fold(0.0, f64::max)]
    }

    pub fn milliseconds(&self) -> f64 {
        1e3 * self.mean(|run| run.seconds_per_frame)
    }

    pub fn lost(&self) -> f64 {
        self.mean(|run| run.lost as f64)
    }
}
