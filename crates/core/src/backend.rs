//! Where poses are scored, particles live and pictures are drawn: this processor, or a device of another package. Chosen
//! once and handed down; nothing in this package knows which it is. A device that fails is an error of the call that failed.

use std::sync::Arc;

pub use crate::backend_error::BackendError;
use crate::{
    camera::Camera,
    field::FieldDimensions,
    filter::{Filter, FilterConfig, ScoredFilter},
    observation::{CpuScorer, ObservationConfig, Scorer},
    warp::{CpuWarper, Warper},
};

/// Makes what runs on one device.
pub trait Backend: Send + Sync {
    /// An observation model that scores poses one call at a time.
    fn scorer(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        config: ObservationConfig,
    ) -> Result<Box<dyn Scorer>, BackendError>;

    /// A particle filter with its observation model. It has no particles before its first [`Filter::initialize`].
    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError>;

    /// What draws pictures from others; threads share it.
    fn warper(&self) -> Result<Arc<dyn Warper>, BackendError>;
}

/// This processor. It never fails.
#[derive(Debug, Clone, Copy, Default)]
pub struct CpuBackend;

impl Backend for CpuBackend {
    fn scorer(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        config: ObservationConfig,
    ) -> Result<Box<dyn Scorer>, BackendError> {
        Ok(Box::new(CpuScorer::new(camera, field, config)))
    }

    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError> {
        let scorer = Box::new(CpuScorer::new(camera, field, observation));
        Ok(Box::new(ScoredFilter::new(scorer, config)))
    }

    fn warper(&self) -> Result<Arc<dyn Warper>, BackendError> {
        Ok(Arc::new(CpuWarper))
    }
}
