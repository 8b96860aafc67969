//! The light on the sensor: a picture in linear values, before it is recorded.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Linear RGB of every pixel, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Light {
    width: usize,
    pixels: Vec<Vec3>,
}

impl Light {
    pub(crate) fn dark([width, height]: [u32; 2]) -> Self {
        Self { width: width as usize, pixels: vec![Vec3::ZERO; width as usize * height as usize] }
    }

    pub(crate) fn rows(&self) -> impl IndexedParallelIterator<Item = &[Vec3]> {
        self.pixels.par_chunks_exact(self.width)
    }

    pub(crate) fn rows_mut(&mut self) -> impl IndexedParallelIterator<Item = &mut [Vec3]> {
        self.pixels.par_chunks_exact_mut(self.width)
    }

    /// Adds a share of the mean light to every pixel.
    pub(crate) fn veiled(mut self, share: f32) -> Self {
        if share != 0.0 {
            let sum = self.pixels.iter().fold(DVec3::ZERO, |sum, light| sum + light.as_dvec3());
            let veil = share * (sum / self.pixels.len().max(1) as f64).as_vec3();
            self.pixels.iter_mut().for_each(|light| *light += veil);
        }
        self
    }

    /// Returns the row at `v`, or the nearest one if `v` is outside the picture.
    pub(crate) fn nearest_row(&self, v: isize) -> &[Vec3] {
        let last = self.pixels.len() / self.width - 1;
        let v = v.clamp(0, last as isize) as usize;
        &self.pixels[v * self.width..(v + 1) * self.width]
    }
}
