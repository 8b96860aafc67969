//! A graphics device as a backend of the core.

use std::sync::Arc;

use reality_sim_core::{
    backend::{Backend, BackendError},
    camera::Camera,
    field::FieldDimensions,
    filter::{Filter, FilterConfig},
    observation::{ObservationConfig, Scorer},
    warp::Warper,
};

use crate::{GpuContext, GpuError, GpuFilter, GpuScorer, GpuWarper};

/// Backend that scores, filters and draws on one graphics device.
#[derive(Debug, Clone)]
pub struct GpuBackend {
    context: Arc<GpuContext>,
}

impl GpuBackend {
    /// Makes a backend of a device that is already open.
    pub fn new(context: Arc<GpuContext>) -> Self {
        Self { context }
    }
}

impl From<GpuError> for BackendError {
    fn from(error: GpuError) -> Self {
        Self::new(error)
    }
}

impl Backend for GpuBackend {
    fn scorer(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        config: ObservationConfig,
    ) -> Result<Box<dyn Scorer>, BackendError> {
        Ok(Box::new(GpuScorer::new(self.context.clone(), camera, field, config)?))
    }

    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError> {
        Ok(Box::new(GpuFilter::new(self.context.clone(), camera, field, observation, config)?))
    }

    fn warper(&self) -> Result<Arc<dyn Warper>, BackendError> {
        Ok(Arc::new(GpuWarper::new(self.context.clone())?))
    }
}
