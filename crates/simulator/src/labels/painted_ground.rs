//! What is painted on the ground: exact for every point, and fast by a table of cells most of which hold one class only.

use glam::DVec2;
use reality_sim_core::{
    camera::{LANES, Lanes},
    field::{Curve, FieldDimensions, MARK_HALF_SIDE_M},
};

use crate::class::Class;

/// Side of a cell, metres: about a line's width, so that few cells hold two classes and the table fits the cache.
const CELL_M: f64 = 0.05;
/// Maximum number of cells along one side.
const MOST_CELLS: f64 = 1024.0;
/// Distance by which a cell is larger than its part of the grid, metres: rounding to single precision moves no point so far.
const ROUNDING_M: f64 = 1e-4;

/// Cell that holds only carpet.
const CARPET: u32 = 0;
/// Cell that holds only paint.
const LINE: u32 = 1;
/// Number of the first cell whose points have to be compared with shapes.
const FIRST_MIXED: u32 = 2;

/// Painted shape, world axes, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// Rectangle along the axes.
    Rectangle { min: DVec2, max: DVec2 },
    /// Ring.
    Ring { center: DVec2, inner_m: f64, outer_m: f64 },
}

/// How much of a cell a shape covers.
enum Cover {
    Nothing,
    Part,
    All,
}

impl Shape {
    fn of_curve(curve: &Curve, half_width_m: f64) -> Self {
        match *curve {
            // Lines run along the axes and meet at their centres: corners are square.
            Curve::Segment { from, to } => {
                Self::Rectangle { min: from.min(to) - half_width_m, max: from.max(to) + half_width_m }
            }
            Curve::Circle { center, radius_m } => {
                Self::Ring { center, inner_m: radius_m - half_width_m, outer_m: radius_m + half_width_m }
            }
        }
    }

    fn holds(&self, point: DVec2) -> bool {
        match *self {
            Self::Rectangle { min, max } => point.cmpge(min).all() && point.cmple(max).all(),
            Self::Ring { center, inner_m, outer_m } => (inner_m..=outer_m).contains(&point.distance(center)),
        }
    }

    /// Returns how much of the rectangle between two corners is covered.
    fn cover(&self, [low, high]: [DVec2; 2]) -> Cover {
        let (touches, covers) = match *self {
            Self::Rectangle { min, max } => {
                (low.cmple(max).all() && high.cmpge(min).all(), low.cmpge(min).all() && high.cmple(max).all())
            }
            Self::Ring { center, inner_m, outer_m } => {
                let nearest_m = center.clamp(low, high).distance(center);
                let farthest_m = (low - center).abs().max((high - center).abs()).length();
                (nearest_m <= outer_m && farthest_m >= inner_m, nearest_m >= inner_m && farthest_m <= outer_m)
            }
        };
        match (touches, covers) {
            (_, true) => Cover::All,
            (true, false) => Cover::Part,
            (false, false) => Cover::Nothing,
        }
    }
}

/// Carpet with its lines and marks.
#[derive(Debug, Clone)]
pub(super) struct PaintedGround {
    half_extent_m: [f32; 2],
    cells_per_m: f32,
    columns: usize,
    cells: Vec<u32>,
    /// Shapes to compare with, by the number of a cell less [`FIRST_MIXED`].
    mixed: Vec<Vec<Shape>>,
}

impl PaintedGround {
    /// Paints the lines of a field.
    pub(super) fn new(field: &FieldDimensions) -> Self {
        let half_width_m = field.line_width_m / 2.0;
        let mark = |center: DVec2| Shape::Rectangle {
            min: center - MARK_HALF_SIDE_M,
            max: center + MARK_HALF_SIDE_M,
        };
        let lines = field.curves();
        let lines = lines.iter().map(|curve| Shape::of_curve(curve, half_width_m));
        let shapes: Vec<Shape> = lines.chain(field.marks().map(mark)).collect();
        let half_extent = field.carpet_half_extent_m();
        let cell_m = CELL_M.max(2.0 * half_extent.max_element() / MOST_CELLS);
        let [columns, rows] = (2.0 * half_extent / cell_m).to_array().map(|count| count.floor() as usize + 1);
        let mut ground = Self {
            half_extent_m: half_extent.as_vec2().to_array(),
            cells_per_m: (1.0 / cell_m) as f32,
            columns,
            cells: Vec::with_capacity(columns * rows),
            mixed: Vec::new(),
        };
        for number in 0..columns * rows {
            let corner =
                DVec2::new((number % columns) as f64, (number / columns) as f64) * cell_m - half_extent;
            ground.push_cell([corner - ROUNDING_M, corner + cell_m + ROUNDING_M], &shapes);
        }
        ground
    }

    fn push_cell(&mut self, corners: [DVec2; 2], shapes: &[Shape]) {
        let mut parts = Vec::new();
        for shape in shapes {
            match shape.cover(corners) {
                Cover::Nothing => {}
                Cover::Part => parts.push(*shape),
                Cover::All => {
                    self.cells.push(LINE);
                    return;
                }
            }
        }
        if parts.is_empty() {
            self.cells.push(CARPET);
        } else {
            self.cells.push(FIRST_MIXED + self.mixed.len() as u32);
            self.mixed.push(parts);
        }
    }

    /// Returns the classes of sixteen points on the ground, world axes, metres; [`Class::Outside`] for NaN.
    #[inline(always)]
    pub(super) fn classes_at(&self, [x_m, y_m]: &[Lanes; 2]) -> [Class; LANES] {
        let [half_x_m, half_y_m] = self.half_extent_m;
        let (columns, last) = (self.columns as f32, (self.cells.len() - 1) as f32);
        let mut is_on_carpet = [0_u32; LANES];
        let mut index = [0_u32; LANES];
        for i in 0..LANES {
            is_on_carpet[i] = u32::from((x_m[i].abs() <= half_x_m) & (y_m[i].abs() <= half_y_m));
            let column = ((x_m[i] + half_x_m) * self.cells_per_m).floor();
            let row = ((y_m[i] + half_y_m) * self.cells_per_m).floor();
            // Whole numbers up to the number of cells are exact; `max` makes 0 of NaN.
            index[i] = (row * columns + column).max(0.0).min(last) as u32;
        }
        let mut cell = [CARPET; LANES];
        for i in 0..LANES {
            cell[i] = self.cells[index[i] as usize];
            cell[i] = if is_on_carpet[i] == 0 { CARPET } else { cell[i] };
        }
        let mut classes = [Class::Outside; LANES];
        let mut mixed = 0;
        for i in 0..LANES {
            mixed |= u32::from(cell[i] >= FIRST_MIXED);
            let painted = if cell[i] == LINE { Class::Line } else { Class::Carpet };
            classes[i] = if is_on_carpet[i] == 0 { Class::Outside } else { painted };
        }
        if mixed != 0 {
            for i in (0..LANES).filter(|i| cell[*i] >= FIRST_MIXED) {
                let point = DVec2::new(f64::from(x_m[i]), f64::from(y_m[i]));
                let shapes = &self.mixed[(cell[i] - FIRST_MIXED) as usize];
                classes[i] =
                    if shapes.iter().any(|shape| shape.holds(point)) { Class::Line } else { Class::Carpet };
            }
        }
        classes
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use reality_sim_core::field::preset_names;

    use super::*;

    impl PaintedGround {
        fn class_at(&self, x_m: f32, y_m: f32) -> Class {
            self.classes_at(&[[x_m; LANES], [y_m; LANES]])[LANES - 1]
        }
    }

    /// The same by the distances of a point from all lines, which square corners but at ends.
    fn slow_class(field: &FieldDimensions, point: DVec2) -> Class {
        let half_width_m = field.line_width_m / 2.0;
        let on_mark =
            field.marks().iter().any(|mark| (point - *mark).abs().max_element() <= MARK_HALF_SIDE_M);
        let on_line = field.curves().iter().any(|curve| curve.distance_m(point) <= half_width_m);
        if point.abs().cmpgt(field.carpet_half_extent_m()).any() {
            Class::Outside
        } else if on_mark || on_line {
            Class::Line
        } else {
            Class::Carpet
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20))]

        #[test]
        fn every_point_has_the_class_that_distances_tell(
            name in proptest::sample::select(preset_names().collect::<Vec<_>>()),
            places in prop::collection::vec((-1.02..1.02, -1.02..1.02), 500),
        ) {
            let field = FieldDimensions::preset(name).unwrap();
            let ground = PaintedGround::new(&field);
            for (x, y) in places {
                let point = DVec2::new(x, y) * field.carpet_half_extent_m();
                let ([x_m, y_m], half_m) = (point.as_vec2().to_array(), field.line_width_m / 2.0);
                let near_an_end = field.curves().iter().any(|curve| match *curve {
                    Curve::Segment { from, to } => [from, to].iter().any(|end| end.distance(point) < 1.5 * half_m),
                    Curve::Circle { .. } => false,
                });
                let near_an_edge = field.curves().iter().any(|c| (c.distance_m(point) - half_m).abs() < 1e-5);
                if !near_an_end && !near_an_edge {
                    prop_assert_eq!(ground.class_at(x_m, y_m), slow_class(&field, point), "{} {}", name, point);
                }
            }
        }
    }

    #[test]
    fn corners_are_square_and_the_carpet_ends() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let ground = PaintedGround::new(&field);
        let (half, half_line) = ([field.length_m / 2.0, field.width_m / 2.0], field.line_width_m / 2.0);
        let beyond = |by_m: f64| ground.class_at((half[0] + by_m) as f32, (half[1] + by_m) as f32);
        assert_eq!(beyond(0.9 * half_line), Class::Line);
        assert_eq!(beyond(1.1 * half_line), Class::Carpet);
        assert_eq!(beyond(half_line + field.border_strip_m + 0.01), Class::Outside);
        assert_eq!(ground.class_at(f32::NAN, 0.0), Class::Outside);
    }
}
