//! Warping: a picture at one pose is drawn from pictures taken at others. Every pixel's ray ends on the proxy geometry
//! of the scene, and the point found there is looked up in the other pictures.
//!
//! The trait [`Warper`] lets other devices do the same.

mod blend;
mod cells;
mod edges;
mod faces;
mod fill;
mod ground;
mod kernel;
mod lanes;
mod look;
mod mix;
mod origin;
mod picture;
mod proxy_geometry;
mod rays;
mod sampling;
mod smooth;
mod surfaces;
mod weights;

pub use self::{
    blend::{Source, Target, Warped, blend, blend_into, complete},
    cells::blend_cells_into,
    fill::fill,
    ground::{GroundColors, ground_colors},
    kernel::Placement,
    look::{Look, UNSEEN_COST},
    origin::Origin,
    picture::Picture,
    proxy_geometry::{Billboard, Hall, ProxyGeometry},
    rays::RayTable,
    surfaces::{Surface, SurfaceBlock},
    weights::{BlendWeights, MAX_SOURCES},
};
use crate::backend_error::BackendError;

/// Draws pictures from others on some device.
pub trait Warper: Send + Sync {
    /// Blends pictures into a buffer, see [`blend_into`]. Fails if the device does; the buffer may then hold anything.
    fn blend_into(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
        colors: &mut [[u8; 3]],
    ) -> Result<Vec<Origin>, BackendError>;

    /// Blends pictures, see [`blend`]. Fails if the device does.
    fn blend(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
    ) -> Result<Warped, BackendError> {
        let mut colors = vec![[0; 3]; target.rays.pixels()];
        let origins = self.blend_into(target, sources, weights, &mut colors)?;
        Ok(Warped { colors, origins })
    }
}

/// Warper on the CPU.
#[derive(Debug, Clone, Copy, Default)]
pub struct CpuWarper;

impl Warper for CpuWarper {
    fn blend_into(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
        colors: &mut [[u8; 3]],
    ) -> Result<Vec<Origin>, BackendError> {
        Ok(blend_cells_into(target, sources, weights, colors))
    }
}

#[cfg(test)]
mod tests;
