//! Depths along the optical axis from distances along the pixels' rays.

use glam::DVec2;
use reality_sim_core::camera::Camera;

/// Share of a ray's length that lies along the optical axis, for every pixel of a camera.
#[derive(Debug)]
pub struct AxisShares {
    camera: Camera,
    shares: Vec<f32>,
}

impl AxisShares {
    /// Computes the shares of a camera: NaN where a ray has no depth, 90° from the axis and beyond, and where the lens has no ray.
    pub fn new(camera: &Camera) -> Self {
        let pixels = (0..camera.height).flat_map(|row| (0..camera.width).map(move |column| (column, row)));
        let share = |(column, row)| {
            let ray = camera.unproject(DVec2::new(f64::from(column), f64::from(row)));
            let along = ray.map_or(f64::NAN, |ray| ray.z);
            if along > 0.0 { along as f32 } else { f32::NAN }
        };
        Self { shares: pixels.map(share).collect(), camera: camera.clone() }
    }

    /// Returns whether these are the shares of a camera.
    pub fn are_of(&self, camera: &Camera) -> bool {
        self.camera == *camera
    }

    /// Returns depths as little-endian bytes.
    pub fn depths(&self, distance_m: &[f32]) -> Vec<u8> {
        self.shares
            .iter()
            .zip(distance_m)
            .flat_map(|(share, distance)| (share * distance).to_le_bytes())
            .collect()
    }
}
