//! The shapes that the world is made of.

use glam::DVec3;

/// A shape in the world, metres.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    /// What looks convex from where it is seen, by its corners in order; they need not lie in a plane.
    Polygon(Vec<DVec3>),
    /// What is between two horizontal circles.
    Ring {
        /// Their centre.
        center: DVec3,
        /// Radius of the smaller; 0 or less for none.
        inner_m: f64,
        /// Radius of the larger.
        outer_m: f64,
    },
}
