//! Cameras with fewer pixels.

use reality_sim_core::camera::{Camera, ImageCircle};

/// Returns the same camera with fewer pixels.
pub(crate) fn smaller(camera: &Camera, size: [u32; 2]) -> Camera {
    let [across, down] =
        [f64::from(size[0]) / f64::from(camera.width), f64::from(size[1]) / f64::from(camera.height)];
    // Pixel centres have whole coordinates: the picture starts half a pixel before the first one.
    let centre = [(camera.cx + 0.5) * across - 0.5, (camera.cy + 0.5) * down - 0.5];
    let intrinsics = [camera.fx * across, camera.fy * down, centre[0], centre[1]];
    let circle = camera.image_circle.map(|circle| ImageCircle {
        cx: (circle.cx + 0.5) * across - 0.5,
        cy: (circle.cy + 0.5) * down - 0.5,
        radius: circle.radius * across.min(down),
    });
    // A valid camera stays valid when its picture shrinks.
    let small = Camera::new(size, intrinsics, camera.distortion).unwrap_or_else(|_| camera.clone());
    small.with_image_circle(circle)
}
