//! Pattern of the ground: which points are white.

use reality_sim_core::field::FieldDimensions;

/// Side of the square marks, metres.
const MARK_M: f32 = 0.1;

/// Painted lines of a field, metres. Lengths between lines are measured between their centres.
#[derive(Debug, Clone, Copy)]
pub struct Pattern {
    half_length: f32,
    half_width: f32,
    half_line: f32,
    area_depth: f32,
    area_half_width: f32,
    mark_distance: f32,
    circle_radius: f32,
    /// Shift of the halfway line towards +x.
    pub halfway_shift_m: f32,
    /// Whether the goal areas at −x and at +x are painted.
    pub goal_areas: [bool; 2],
}

impl Pattern {
    /// Makes the lines of a field of these dimensions.
    pub fn new(field: &FieldDimensions) -> Self {
        Self {
            half_length: field.length_m as f32 / 2.0,
            half_width: field.width_m as f32 / 2.0,
            half_line: field.line_width_m as f32 / 2.0,
            area_depth: field.goal_area_length_m as f32,
            area_half_width: field.goal_area_width_m as f32 / 2.0,
            mark_distance: field.penalty_mark_distance_m as f32,
            circle_radius: field.center_circle_diameter_m as f32 / 2.0,
            halfway_shift_m: 0.0,
            goal_areas: [true; 2],
        }
    }

    /// Moves the lines to a field of other dimensions; missing lines stay missing.
    pub fn resize(&mut self, field: &FieldDimensions) {
        *self =
            Self { halfway_shift_m: self.halfway_shift_m, goal_areas: self.goal_areas, ..Self::new(field) };
    }

    /// Returns the distance to the nearest white paint, metres; negative inside paint, where its magnitude is at most the
    /// distance to the edge.
    pub fn distance_m(&self, x: f32, y: f32) -> f32 {
        let (ax, ay) = (x.abs(), y.abs());
        let border = outline(ax, ay, self.half_length, self.half_width, self.half_line);
        let halfway = rectangle(x - self.halfway_shift_m, ay, self.half_line, self.half_width);
        let circle = ((x * x + y * y).sqrt() - self.circle_radius).abs() - self.half_line;
        let center_mark = rectangle(ax, ay, MARK_M / 2.0, MARK_M / 2.0);
        let mark = rectangle(ax - self.half_length + self.mark_distance, ay, MARK_M / 2.0, MARK_M / 2.0);
        let area = if self.goal_areas[usize::from(x > 0.0)] {
            let from_center = ax - self.half_length + self.area_depth / 2.0;
            outline(from_center, ay, self.area_depth / 2.0, self.area_half_width, self.half_line)
        } else {
            f32::INFINITY
        };
        border.min(halfway).min(circle).min(center_mark).min(mark).min(area)
    }
}

/// Returns the distance to a rectangle about the origin with these half sides.
fn rectangle(x: f32, y: f32, half_x: f32, half_y: f32) -> f32 {
    let (dx, dy) = (x.abs() - half_x, y.abs() - half_y);
    if dx > 0.0 && dy > 0.0 { (dx * dx + dy * dy).sqrt() } else { dx.max(dy) }
}

/// Returns the distance to the outline, painted with a line's width, of a rectangle with these half sides.
fn outline(x: f32, y: f32, half_x: f32, half_y: f32, half_line: f32) -> f32 {
    let outer = rectangle(x, y, half_x + half_line, half_y + half_line);
    let inner = rectangle(x, y, half_x - half_line, half_y - half_line);
    outer.max(-inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nominal::kid_size_field;

    #[test]
    fn paint_lies_where_the_dimensions_put_it() {
        let pattern = Pattern::new(&kid_size_field());
        let white = |x: f32, y: f32| pattern.distance_m(x, y) < 0.0;
        for (x, y) in
            [(3.024, 2.024), (-2.976, 0.0), (0.0, 1.5), (0.6, 0.0), (2.4, -1.0), (2.7, 1.1), (1.24, 0.04)]
        {
            assert!(white(x, y), "({x}, {y})");
        }
        for (x, y) in
            [(3.026, 0.0), (2.97, 1.97), (0.03, 1.5), (0.4, 0.4), (2.43, -1.0), (1.26, 0.0), (2.7, 0.0)]
        {
            assert!(!white(x, y), "({x}, {y})");
        }
    }

    #[test]
    fn an_unpainted_goal_area_leaves_the_goal_line() {
        let pattern = Pattern { goal_areas: [true, false], ..Pattern::new(&kid_size_field()) };
        assert!(pattern.distance_m(2.4, 0.5) > 0.0 && pattern.distance_m(-2.4, 0.5) < 0.0);
        assert!(pattern.distance_m(3.0, 0.5) < 0.0);
    }
}
