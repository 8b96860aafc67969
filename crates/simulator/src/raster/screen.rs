//! Triangles in the picture.

use glam::{DVec2, Vec3};

/// Corner of a triangle in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    /// Pixel, which may lie outside the picture.
    pub(crate) pixel: DVec2,
    /// Distance from the camera, metres.
    pub(crate) distance_m: f64,
    /// Linear red, green and blue.
    pub(crate) color: Vec3,
}

/// Triangle whose sides are straight in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScreenTriangle {
    pub(crate) corners: [Corner; 3],
}

impl ScreenTriangle {
    pub(crate) fn middle(&self) -> DVec2 {
        self.corners.iter().map(|corner| corner.pixel).sum::<DVec2>() / 3.0
    }

    pub(crate) fn area_px2(&self) -> f64 {
        let [a, b, c] = self.corners.map(|corner| corner.pixel);
        0.5 * (b - a).perp_dot(c - a).abs()
    }
}
