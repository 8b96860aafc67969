//! Where poses are scored, particles live and pictures are drawn: this processor, or a device of another package. Chosen
//! once and handed down; nothing in this package knows which it is.

use std::sync::Arc;

use crate::{
    camera::Camera,
    field::FieldDimensions,
    filter::{Filter, FilterConfig, ScoredFilter},
    observation::{CpuScorer, ObservationConfig, Scorer},
    warp::{CpuWarper, Warper},
};

/// A device that cannot do what was asked for, or no longer works: what is wrong, and what to do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct BackendError(pub String);

/// Makes what runs on one device.
pub trait Backend: Send + Sync {
    /// An observation model that scores poses one call at a time.
    fn scorer(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        config: ObservationConfig,
    ) -> Result<Box<dyn Scorer>, BackendError>;

    /// A particle filter with its observation model. It has no particles before its first [`Filter::place`].
    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError>;

    /// What draws pictures from others; threads share it.
    fn warper(&self) -> Result<Arc<dyn Warper>, BackendError>;

    /// What has gone wrong on the device so far. What was scored since is worth nothing.
    fn status(&self) -> Result<(), BackendError>;
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

    fn status(&self) -> Result<(), BackendError> {
        Ok(())
    }
}
