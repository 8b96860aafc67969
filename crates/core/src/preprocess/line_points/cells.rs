//! Points sorted into square cells, so that those near a point are found without a look at all of them.

use glam::DVec2;

/// Points of a picture by the cells in which they lie.
pub(super) struct PointCells {
    side_px: f64,
    columns: usize,
    cells: Vec<Vec<DVec2>>,
}

impl PointCells {
    /// Sorts the points of a picture of this width and height into cells of this side, pixels.
    pub fn new(points: &[DVec2], [width, height]: [usize; 2], side_px: f64) -> Self {
        let count = |length: usize| (length as f64 / side_px) as usize + 1;
        let cells = vec![Vec::new(); count(width) * count(height)];
        let mut sorted = Self { side_px, columns: count(width), cells };
        for &point in points {
            let [column, row] = sorted.cell(point);
            sorted.cells[row * sorted.columns + column].push(point);
        }
        sorted
    }

    /// Returns the points of a point's cell and of those around it: all within a cell's side, and others.
    pub fn around(&self, point: DVec2) -> impl Iterator<Item = DVec2> {
        let [column, row] = self.cell(point);
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        (row.saturating_sub(1)..row + 2)
            .flat_map(move |row| columns.clone().map(move |column| row * self.columns + column))
            .filter_map(|index| self.cells.get(index))
            .flatten()
            .copied()
    }

    fn cell(&self, point: DVec2) -> [usize; 2] {
        [point.x, point.y].map(|at| (at / self.side_px) as usize)
    }
}
