//! Coordinates that residuals are binned by.

use glam::DVec2;

use crate::{
    diagnostics::detector::FrameResiduals,
    diagnostics::finding::PatternCell,
    measurement::scalar::Measurement,
    thresholds::{PatternThresholds, Thresholds},
};

const THRESHOLDS: PatternThresholds = Thresholds::DEFAULT.diagnostics.patterns;
const GRID: [usize; 2] = THRESHOLDS.picture_grid;
const FIELD_CELL_M: f64 = THRESHOLDS.field_cell_m;
const TIME_CELL_S: f64 = THRESHOLDS.time_cell_s;
const SPEED_CELL: f64 = THRESHOLDS.speed_cell;

/// Cell by its indices along the one or two axes of a locus.
pub(super) type Cell = (i32, i32);

/// Coordinate that residuals are binned by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Locus {
    /// Place in the picture.
    Picture,
    /// Place on the field.
    Field,
    /// Time since the recording's start.
    Time,
    /// Speed at which a line moves across itself in the picture.
    Speed,
}

impl Locus {
    /// Returns the cell of a measurement in a frame of a recording that starts at `start_s`.
    pub(super) fn cell(self, measurement: &Measurement, frame: &FrameResiduals<'_>, start_s: f64) -> Cell {
        match self {
            Self::Picture => picture_cell(measurement.pixel, frame.size),
            Self::Field => (
                (measurement.ground.x / FIELD_CELL_M).floor() as i32,
                (measurement.ground.y / FIELD_CELL_M).floor() as i32,
            ),
            Self::Time => (((frame.time_s - start_s) / TIME_CELL_S).floor() as i32, 0),
            Self::Speed => {
                let widths_per_s = measurement.speed_px_s.abs() / f64::from(frame.size[0]);
                ((widths_per_s.sqrt() / SPEED_CELL).floor() as i32, 0)
            }
        }
    }

    /// Returns a cell in units of the picture, the field, time or speed.
    pub(super) fn pattern_cell(self, cell: Cell) -> PatternCell {
        let middle = |index: i32, side: f64| side * (f64::from(index) + 0.5);
        match self {
            Self::Picture => {
                let [column, row] = [cell.0, cell.1].map(|index| index.max(0) as usize);
                PatternCell::Picture { column, row, grid: GRID }
            }
            Self::Field => {
                PatternCell::Field { x_m: middle(cell.0, FIELD_CELL_M), y_m: middle(cell.1, FIELD_CELL_M) }
            }
            Self::Time => PatternCell::Time { after_s: TIME_CELL_S * f64::from(cell.0) },
            Self::Speed => PatternCell::Speed { widths_per_s: middle(cell.0, SPEED_CELL).powi(2) },
        }
    }
}

/// Returns the cell of the picture's grid that a pixel is in.
pub(super) fn picture_cell(pixel: DVec2, size: [u32; 2]) -> Cell {
    let cell = |value: f64, size: u32, cells: usize| {
        ((value + 0.5) / f64::from(size) * cells as f64).clamp(0.0, cells as f64 - 1.0) as i32
    };
    (cell(pixel.x, size[0], GRID[0]), cell(pixel.y, size[1], GRID[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_and_the_last_pixel_are_in_opposite_corners_of_the_grid() {
        assert_eq!(picture_cell(DVec2::ZERO, [320, 240]), (0, 0));
        assert_eq!(picture_cell(DVec2::new(319.0, 239.0), [320, 240]), (7, 5));
        assert_eq!(picture_cell(DVec2::new(-9.0, 999.0), [320, 240]), (0, 5));
    }

    #[test]
    fn cells_of_the_field_and_of_speed_are_stated_by_their_middle_and_those_of_time_by_their_start() {
        assert_eq!(Locus::Field.pattern_cell((1, -1)), PatternCell::Field { x_m: 1.5, y_m: -0.5 });
        let PatternCell::Speed { widths_per_s } = Locus::Speed.pattern_cell((2, 0)) else { panic!() };
        assert!((widths_per_s - 0.25).abs() < 1e-12);
        assert_eq!(Locus::Time.pattern_cell((3, 0)), PatternCell::Time { after_s: 3.0 });
    }
}
