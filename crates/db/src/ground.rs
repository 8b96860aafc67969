//! Carpet of a field as all pictures together show it, without the things that stood on it.

use glam::DVec2;
use image::{GrayImage, RgbImage};

/// Largest number of cells of a ground.
const MOST_CELLS: u64 = 1 << 22;
/// Largest distance of the carpet's corner from the field's centre, metres.
const FARTHEST_M: f64 = 1000.0;
/// Sides that a cell can have, metres.
const CELL_SIDES_M: std::ops::RangeInclusive<f64> = 1e-3..=1.0;

/// Mosaic of a field's carpet, in square cells along the field's axes. Columns run along +x, rows along +y.
#[derive(Debug, Clone, PartialEq)]
pub struct Ground {
    /// Corner of the first cell: the smallest coordinates, metres.
    pub min_m: DVec2,
    /// Side of a cell, metres.
    pub cell_m: f64,
    /// Colours of the cells. Those that were never seen empty continue the cells around them.
    pub colors: RgbImage,
    /// Numbers of directions from which cells were seen empty: 0 where something always stood, or nothing was seen.
    pub views: GrayImage,
}

impl Ground {
    /// Returns whether its numbers are possible, and every cell has both a colour and a number of views.
    pub fn is_possible(&self) -> bool {
        Self::has_place(self.min_m, self.cell_m)
            && Self::has_size(self.colors.width(), self.colors.height())
            && self.colors.dimensions() == self.views.dimensions()
    }

    pub(crate) fn has_place(min_m: DVec2, cell_m: f64) -> bool {
        min_m.is_finite() && min_m.abs().max_element() <= FARTHEST_M && CELL_SIDES_M.contains(&cell_m)
    }

    pub(crate) fn has_size(width: u32, height: u32) -> bool {
        (1..=MOST_CELLS).contains(&(u64::from(width) * u64::from(height)))
    }

    /// Returns the share of the cells that were never seen empty.
    pub fn unknown_share(&self) -> f64 {
        let unknown = self.views.iter().filter(|views| **views == 0).count();
        unknown as f64 / self.views.len().max(1) as f64
    }
}
