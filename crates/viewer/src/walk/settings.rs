//! Settings of Walk.

use reality_sim_core::{
    filter::Resampling,
    localization::LocalizerConfig,
    observation::{ObservationConfig, ObservationKind},
};
use serde::{Deserialize, Serialize};

/// All settings of Walk that are kept.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct WalkSettings {
    pub filter: FilterSettings,
    pub speed: Speed,
    pub layers: Layers,
}

/// Settings of the filter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FilterSettings {
    pub observation: ObservationConfig,
    pub particles: usize,
    pub iterations: u32,
    pub resampling: Resampling,
    /// Whether to search the field when the filter seems to be lost.
    pub recovery: bool,
    pub odometry: bool,
    pub seed: u64,
    /// Name of the chosen device; the first device if no device has it.
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
    /// Sets another observation model, with its own defaults.
    pub fn set_model(&mut self, kind: ObservationKind) {
        self.observation = ObservationConfig::new(kind);
    }

    /// Returns the configuration of the localizer.
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

/// Playback speed of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Speed {
    /// The speed of the recording.
    #[default]
    Recorded,
    /// Five times the speed of the recording.
    Fast,
    /// The filter's own speed, as fast as it runs.
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

    /// Returns the factor on the recording's own speed.
    pub fn factor(self) -> f64 {
        match self {
            Self::Recorded => 1.0,
            Self::Fast => 5.0,
            Self::Filter => f64::INFINITY,
        }
    }
}

/// Picture that can be laid over the camera's.
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

/// Layers drawn into picture and field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layers {
    pub pose: bool,
    pub best_particle: bool,
    pub truth: bool,
    pub border: bool,
    pub veil: Veil,
    /// Opacity of the veil, 0 to 1.
    pub veil_opacity: f32,
    pub particles: bool,
    /// Whether a cloud of particles too small to be seen is shown enlarged.
    pub inset: bool,
    pub path: bool,
    pub odometry: bool,
    pub footprint: bool,
    /// Whether to keep the estimated pose in the centre of an enlarged view.
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
            inset: true,
            path: true,
            odometry: true,
            footprint: true,
            follow: true,
        }
    }
}
