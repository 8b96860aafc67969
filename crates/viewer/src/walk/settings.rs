//! What a person sets in Walk.

use reality_sim_core::{
    filter::Resampling,
    localization::LocalizerConfig,
    observation::{ObservationConfig, ObservationKind},
};
use serde::{Deserialize, Serialize};

/// Everything in Walk that is remembered.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct WalkSettings {
    pub filter: FilterSettings,
    pub speed: Speed,
    pub layers: Layers,
}

/// What the filter is run with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FilterSettings {
    pub observation: ObservationConfig,
    pub particles: usize,
    pub iterations: u32,
    pub resampling: Resampling,
    /// Search the field when the filter seems to be lost.
    pub recovery: bool,
    pub odometry: bool,
    pub seed: u64,
    /// The name of one of the devices; the first where there is none of this name.
    pub device: String,
}

impl Default for FilterSettings {
    fn default() -> Self {
        let LocalizerConfig { observation, filter, uses_odometry, relocalizes, .. } =
            LocalizerConfig::default();
        Self {
            observation,
            particles: filter.particles,
            iterations: filter.iterations,
            resampling: filter.resampling,
            recovery: relocalizes,
            odometry: uses_odometry,
            seed: filter.seed,
            device: String::new(),
        }
    }
}

impl FilterSettings {
    /// Takes another model, with its own defaults.
    pub fn set_model(&mut self, kind: ObservationKind) {
        self.observation = ObservationConfig::new(kind);
    }

    /// As the filter takes it.
    pub fn config(&self) -> LocalizerConfig {
        let mut config = LocalizerConfig::new(self.observation.kind);
        config.observation = self.observation;
        config.filter.particles = self.particles;
        config.filter.iterations = self.iterations;
        config.filter.resampling = self.resampling;
        config.filter.seed = self.seed;
        config.relocalizes = self.recovery;
        config.uses_odometry = self.odometry;
        config
    }
}

/// How fast a recording is played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Speed {
    /// As it was recorded.
    #[default]
    Recorded,
    /// Five times as fast.
    Fast,
    /// As fast as the filter is.
    Filter,
}

impl Speed {
    pub const ALL: [Self; 3] = [Self::Recorded, Self::Fast, Self::Filter];

    pub fn name(self) -> &'static str {
        match self {
            Self::Recorded => "as recorded",
            Self::Fast => "5 × as fast",
            Self::Filter => "as fast as the filter",
        }
    }

    /// Times the recording's own speed.
    pub fn factor(self) -> f64 {
        match self {
            Self::Recorded => 1.0,
            Self::Fast => 5.0,
            Self::Filter => f64::INFINITY,
        }
    }
}

/// A picture that can be laid over the camera's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Veil {
    #[default]
    None,
    Blurred,
    Evidence,
    Distances,
}

impl Veil {
    pub const ALL: [Self; 4] = [Self::None, Self::Blurred, Self::Evidence, Self::Distances];

    pub fn name(self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Blurred => "blurred picture",
            Self::Evidence => "white-line evidence",
            Self::Distances => "distances",
        }
    }

    pub fn explanation(self) -> &'static str {
        match self {
            Self::None => "The camera's picture as it is",
            Self::Blurred => {
                "Grey values blurred by the model's sigma: what gauss (Eq. 2) adds up along the lines"
            }
            Self::Evidence => {
                "Pixels that look like a white line on carpet: what distance (Eq. 1) measures to"
            }
            Self::Distances => {
                "How far each pixel is from the next white one, black 0, white 32 pixels or more"
            }
        }
    }
}

/// What is drawn into picture and field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layers {
    pub pose: bool,
    pub best_particle: bool,
    pub truth: bool,
    pub border: bool,
    pub veil: Veil,
    /// How much the veil hides, 0 to 1.
    pub veil_opacity: f32,
    pub particles: bool,
    pub path: bool,
    pub odometry: bool,
    pub footprint: bool,
    /// Keep the pose found in the middle of an enlarged view.
    pub follow: bool,
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            pose: true,
            best_particle: false,
            truth: true,
            border: false,
            veil: Veil::None,
            veil_opacity: 0.8,
            particles: true,
            path: true,
            odometry: true,
            footprint: true,
            follow: true,
        }
    }
}
