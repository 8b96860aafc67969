//! Square cells on the carpet.

use glam::DVec2;
use reality_sim_core::field::FieldDimensions;

/// Cells along the field's axes: columns run along +x, rows along +y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// Corner of the first cell, metres.
    pub min_m: DVec2,
    /// Side of a cell, metres.
    pub cell_m: f64,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

impl Grid {
    /// Covers a field's carpet with cells of about this size.
    pub fn of_carpet(field: &FieldDimensions, cell_m: f64) -> Self {
        let half = field.carpet_half_extent_m();
        let cells = (2.0 * half / cell_m).ceil().max(DVec2::ONE);
        let min_m = -cells * cell_m / 2.0;
        Self { min_m, cell_m, width: cells.x as usize, height: cells.y as usize }
    }

    /// Returns the number of cells.
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Returns the centre of a cell, metres.
    pub fn center_m(&self, cell: usize) -> DVec2 {
        let [column, row] = [cell % self.width, cell / self.width];
        self.min_m + self.cell_m * (DVec2::new(column as f64, row as f64) + 0.5)
    }

    /// Returns the cell that holds a point, if one does.
    pub fn cell_at(&self, point_m: DVec2) -> Option<usize> {
        let place = (point_m - self.min_m) / self.cell_m;
        let is_inside =
            place.cmpge(DVec2::ZERO).all() && place.x < self.width as f64 && place.y < self.height as f64;
        is_inside.then_some(place.y as usize * self.width + place.x as usize)
    }
}
