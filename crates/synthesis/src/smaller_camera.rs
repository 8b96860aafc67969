//! Cameras with fewer pixels.

use reality_sim_core::camera::Camera;

/// Returns the same camera with fewer pixels.
pub(crate) fn smaller(camera: &Camera, size: [u32; 2]) -> Camera {
    // A valid camera stays valid when its picture shrinks.
    camera.resized(size).unwrap_or_else(|_| camera.clone())
}
