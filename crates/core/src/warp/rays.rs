//! Viewing directions of a camera's pixels, computed once.

use std::{ops::Range, sync::Arc};

use glam::DVec2;
use rayon::prelude::*;

use super::Origin;
use crate::camera::{Camera, LANES, Lanes};

/// Unit directions of sixteen neighbouring pixels of a row in the camera's axes; NaN where a pixel sees nothing.
pub(crate) type RayBlock = [Lanes; 3];

/// Viewing directions of all pixels of a camera.
#[derive(Debug, Clone)]
pub struct RayTable {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    blocks_in_row: usize,
    blocks: Arc<Vec<RayBlock>>,
    /// Runs of pixels, row by row, that see nothing.
    outside: Arc<Vec<Range<usize>>>,
}

impl RayTable {
    /// Computes the ray of every pixel.
    pub fn new(camera: &Camera) -> Self {
        let blocks_in_row = (camera.width as usize).div_ceil(LANES);
        let rows = (0..camera.height).into_par_iter();
        let blocks =
            rows.flat_map_iter(|row| (0..blocks_in_row).map(move |block| ray_block(camera, block, row)));
        let blocks: Vec<RayBlock> = blocks.collect();
        let width = camera.width as usize;
        let is_outside = |pixel: usize| {
            blocks[pixel / width * blocks_in_row + pixel % width / LANES][0][pixel % width % LANES].is_nan()
        };
        let outside = Arc::new(runs(width * camera.height as usize, is_outside));
        let blocks = Arc::new(blocks);
        Self { width: camera.width, height: camera.height, blocks_in_row, blocks, outside }
    }

    /// Returns the number of pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Returns unit directions in the camera's axes, row by row from the top. A block holds the right, down and forward
    /// components of sixteen neighbouring pixels of a row; NaN where a pixel sees nothing and beyond the row's end.
    /// Clones of a table share them.
    pub fn blocks(&self) -> &Arc<Vec<[Lanes; 3]>> {
        &self.blocks
    }

    /// Marks the pixels, row by row, that see nothing because the lens leaves them black.
    pub fn mark_outside(&self, origins: &mut [Origin]) {
        for run in self.outside.iter() {
            origins[run.clone()].fill(Origin { source: Origin::OUTSIDE, trust: 0 });
        }
    }

    /// Returns runs of pixels, row by row, that see nothing.
    pub(crate) fn outside(&self) -> &[Range<usize>] {
        &self.outside
    }

    /// Returns the directions of a row, sixteen pixels per block; the last block is padded with NaN.
    pub(crate) fn row(&self, row: usize) -> &[RayBlock] {
        &self.blocks[row * self.blocks_in_row..(row + 1) * self.blocks_in_row]
    }
}

fn ray_block(camera: &Camera, block: usize, row: u32) -> RayBlock {
    let mut rays = [[f32::NAN; LANES]; 3];
    for lane in 0..LANES {
        let pixel = DVec2::new((block * LANES + lane) as f64, f64::from(row));
        if camera.check_inside(pixel).is_ok()
            && let Ok(ray) = camera.unproject(pixel)
        {
            for (axis, value) in rays.iter_mut().zip(ray.to_array()) {
                axis[lane] = value as f32;
            }
        }
    }
    rays
}

/// Returns the runs of numbers below `count` that are of a kind.
fn runs(count: usize, is_of_kind: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for number in (0..count).filter(|number| is_of_kind(*number)) {
        match runs.last_mut() {
            Some(run) if run.end == number => run.end = number + 1,
            _ => runs.push(number..number + 1),
        }
    }
    runs
}
