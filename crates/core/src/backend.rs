//! Backend: where poses are scored, particles live and pictures are warped, on the CPU or a device of another package.
//! It is chosen once and passed down; nothing else in this package depends on the choice. If a device fails, the call
//! returns an error.

use std::sync::Arc;

pub use crate::{backend_error::BackendError, device_choice::DeviceChoice};
use crate::{
    camera::Camera,
    field::FieldDimensions,
    filter::{Filter, FilterConfig, ScoredFilter},
    observation::{CpuScorer, ObservationConfig, Scorer},
    warp::{CpuWarper, Warper},
};

/// Makes scorers, filters and warpers that run on one device. What an implementation leaves out runs on the CPU.
pub trait Backend: Send + Sync {
    /// Makes an observation model that scores poses. Fails if the device cannot provide it.
    fn scorer(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        config: ObservationConfig,
    ) -> Result<Box<dyn Scorer>, BackendError> {
        Ok(Box::new(CpuScorer::new(camera, field, config)))
    }

    /// Makes a particle filter with its observation model. It has no particles before its first [`Filter::initialize`].
    /// Fails if the device cannot provide it.
    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError> {
        Ok(Box::new(ScoredFilter::new(self.scorer(camera, field, observation)?, config)))
    }

    /// Returns a warper, which threads may share. Fails if the device cannot provide it.
    fn warper(&self) -> Result<Arc<dyn Warper>, BackendError> {
        Ok(Arc::new(CpuWarper))
    }
}

/// Backend on the CPU. It never fails.
#[derive(Debug, Clone, Copy, Default)]
pub struct CpuBackend;

impl Backend for CpuBackend {}
