//! Shapes of the scene.

use glam::DVec3;

/// Shape in the world, metres.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    /// Outline that is convex as seen from the camera, by its corners in order; they need not be coplanar.
    Polygon(Vec<DVec3>),
    /// Area between two horizontal circles.
    Ring {
        /// Common centre.
        center: DVec3,
        /// Inner radius; 0 or less for a full disc.
        inner_m: f64,
        /// Outer radius.
        outer_m: f64,
    },
}
