//! Settings of `tag`, by the names of its options.

use reality_sim_core::{
    filter::{Estimator, KldConfig, Resampling},
    localization::LocalizerConfig,
    observation::ObservationKind,
};
use serde::{Deserialize, Serialize};

/// Settings with which a recording is tagged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TagSettings {
    /// Observation model, which weighs the particles.
    pub observation: ObservationKind,
    /// Number of particles; the largest one where it adapts.
    pub particles: usize,
    /// Iterations of weighing and resampling for each picture.
    pub iterations: u32,
    /// Resampling scheme.
    pub resampling: Resampling,
    /// Estimate of the pose from the particles.
    pub estimator: Estimator,
    /// Whether the number of particles adapts to their spread (KLD-sampling).
    pub adaptive: bool,
    /// Whether all poses of the recording are smoothed together.
    pub smooth: bool,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Standard deviation of the picture's Gaussian blur, pixels; `None` for the model's own.
    pub blur_px: Option<f32>,
    /// The paper's α; `None` for the model's own.
    pub alpha: Option<f64>,
    /// Whether what lies outside the field's border is masked.
    pub border_mask: bool,
    /// Whether odometry is used.
    pub odometry: bool,
    /// Whether the field is searched when the pose is lost.
    pub recovery: bool,
    /// Whether the start that a recording gives is used.
    pub known_start: bool,
    /// Whether covariances contain the calibration's errors, as stated or as the recording tells: some pictures are then looked at
    /// once more.
    pub calibration_errors: bool,
}

impl Default for TagSettings {
    fn default() -> Self {
        let config = LocalizerConfig::default();
        Self {
            observation: config.observation.kind,
            particles: config.filter.particles,
            iterations: config.filter.iterations,
            resampling: config.filter.resampling,
            estimator: config.filter.estimator,
            adaptive: false,
            smooth: false,
            seed: 0,
            blur_px: None,
            alpha: None,
            border_mask: true,
            odometry: true,
            recovery: true,
            known_start: true,
            calibration_errors: false,
        }
    }
}

impl TagSettings {
    /// Returns the settings of the localizer.
    pub fn config(&self) -> LocalizerConfig {
        let mut config = LocalizerConfig::new(self.observation);
        let observation = &mut config.observation;
        observation.blur_sigma_px = self.blur_px.unwrap_or(observation.blur_sigma_px);
        observation.alpha = self.alpha.unwrap_or(observation.alpha);
        observation.mask_border = self.border_mask;
        config.filter.particles = self.particles;
        config.filter.iterations = self.iterations;
        config.filter.resampling = self.resampling;
        config.filter.estimator = self.estimator;
        config.filter.seed = self.seed;
        config.filter.adaptive = self.adaptive.then(KldConfig::default);
        config.uses_odometry = self.odometry;
        config.relocalizes = self.recovery;
        config.refines |= self.smooth;
        config
    }
}
