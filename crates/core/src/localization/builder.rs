//! Builder of a localizer.

use std::{fmt, sync::Arc};

use super::{config::LocalizerConfig, error::LocalizationError, localizer::Localizer};
use crate::{
    backend::{Backend, CpuBackend},
    camera::Camera,
    field::FieldDimensions,
    goal_colors::GoalColors,
    pose::Pose2,
    preprocess::Preprocessor,
    refine::{CalibrationUncertainty, Refiner},
    search::GlobalSearch,
};

/// Settings of a [`Localizer`] that has yet to be built.
#[derive(Clone)]
pub struct LocalizerBuilder<'a> {
    camera: &'a Camera,
    field: &'a FieldDimensions,
    config: LocalizerConfig,
    backend: Arc<dyn Backend>,
    start: Option<Pose2>,
    calibration: Option<CalibrationUncertainty>,
}

impl Localizer {
    /// Returns a builder of a localizer for this camera and field. By default it uses the default settings, runs on the CPU
    /// and does not know where the camera starts.
    pub fn builder<'a>(camera: &'a Camera, field: &'a FieldDimensions) -> LocalizerBuilder<'a> {
        let backend = Arc::new(CpuBackend);
        LocalizerBuilder {
            camera,
            field,
            config: LocalizerConfig::default(),
            backend,
            start: None,
            calibration: None,
        }
    }
}

impl LocalizerBuilder<'_> {
    /// Replaces the settings.
    pub fn config(self, config: LocalizerConfig) -> Self {
        Self { config, ..self }
    }

    /// Runs the computations on another device.
    pub fn backend(self, backend: Arc<dyn Backend>) -> Self {
        Self { backend, ..self }
    }

    /// Sets the pose of the camera at the first picture; `None` if it is unknown.
    pub fn start(self, start: impl Into<Option<Pose2>>) -> Self {
        Self { start: start.into(), ..self }
    }

    /// Sets how far lens and mount can be trusted, which becomes part of the covariances; `None` takes them as exact. Where it
    /// says how far height, pitch and roll are from the mount's, this replaces the settings' own value.
    pub fn calibration(self, calibration: Option<CalibrationUncertainty>) -> Self {
        Self { calibration, ..self }
    }

    /// Builds the localizer. Fails if the device cannot do what the settings ask for.
    pub fn build(self) -> Result<Localizer, LocalizationError> {
        let Self { camera, field, config, backend, start, calibration } = self;
        let measured = calibration.as_ref().and_then(CalibrationUncertainty::mount_sigma);
        let config = measured.map_or(config, |sigma| config.with_mount_sigma(sigma));
        let refiner =
            Refiner::new(camera, field, config.refine, config.mount_sigma).with_calibration(calibration);
        Ok(Localizer {
            config,
            size: [camera.width, camera.height],
            preprocessor: Preprocessor::new(camera, field.line_width_m),
            filter: backend.filter(camera, field, config.observation, config.filter)?,
            search: GlobalSearch::with_backend(
                camera,
                field,
                config.relocalization.search,
                refiner,
                &*backend,
            )?,
            goal_colors: GoalColors::new(camera, field, config.goal_colors),
            start,
            track: None,
            picture: None,
            frame: 0,
        })
    }
}

impl fmt::Debug for LocalizerBuilder<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = formatter.debug_struct("LocalizerBuilder");
        debug.field("config", &self.config).field("start", &self.start).finish_non_exhaustive()
    }
}
