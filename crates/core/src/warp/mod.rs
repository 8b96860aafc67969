//! A picture at one pose from pictures taken at others: every pixel's ray ends on a shape that stands for the world, and
//! the point found there is looked up in the other pictures.
//!
//! On other devices the same is done behind the trait [`Warper`].

mod blend;
mod fill;
mod kernel;
mod origin;
mod picture;
mod proxy_geometry;
mod rays;

pub use self::{
    blend::{BlendWeights, MAX_SOURCES, Source, Target, Warped, blend, costs, glimpses},
    kernel::Placement,
    origin::Origin,
    picture::Picture,
    proxy_geometry::{Billboard, Hall, ProxyGeometry},
    rays::RayTable,
};
use crate::backend_error::BackendError;

/// Draws pictures from others on some device.
pub trait Warper: Send + Sync {
    /// See [`blend`].
    fn blend(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
    ) -> Result<Warped, BackendError>;
}

/// The processor.
#[derive(Debug, Clone, Copy, Default)]
pub struct CpuWarper;

impl Warper for CpuWarper {
    fn blend(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
    ) -> Result<Warped, BackendError> {
        Ok(blend(target, sources, weights))
    }
}

#[cfg(test)]
mod tests;
