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
    /// Depth and half width of the penalty areas, if there are any.
    penalty_area: Option<[f32; 2]>,
    /// Shift of the halfway line towards +x.
    pub halfway_shift_m: f32,
    /// Additional width of the halfway line.
    pub halfway_extra_m: f32,
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
            penalty_area: field
                .penalty_area_length_m
                .zip(field.penalty_area_width_m)
                .map(|(depth_m, width_m)| [depth_m as f32, width_m as f32 / 2.0]),
            halfway_shift_m: 0.0,
            halfway_extra_m: 0.0,
            goal_areas: [true; 2],
        }
    }

    /// Moves the lines to a field of other dimensions; missing lines stay missing.
    pub fn resize(&mut self, field: &FieldDimensions) {
        *self = Self {
            halfway_shift_m: self.halfway_shift_m,
            halfway_extra_m: self.halfway_extra_m,
            goal_areas: self.goal_areas,
            ..Self::new(field)
        };
    }

    /// Returns the distance to the nearest white paint, metres; negative inside paint, where its magnitude is at most the
    /// distance to the edge.
    pub fn distance_m(&self, x: f32, y: f32) -> f32 {
        self.distances_m(x, y).into_iter().fold(f32::INFINITY, f32::min)
    }

    /// Returns the distances to the parts of the pattern: outline, halfway line, circle, centre mark, penalty marks, goal
    /// areas, penalty areas.
    pub fn distances_m(&self, x: f32, y: f32) -> [f32; 7] {
        let (ax, ay) = (x.abs(), y.abs());
        let half_halfway = self.half_line + self.halfway_extra_m / 2.0;
        let from_goal_line = ax - self.half_length;
        let area = |depth: f32, half_width: f32| {
            outline(from_goal_line + depth / 2.0, ay, depth / 2.0, half_width, self.half_line)
        };
        [
            outline(ax, ay, self.half_length, self.half_width, self.half_line),
            rectangle(x - self.halfway_shift_m, ay, half_halfway, self.half_width),
            ((x * x + y * y).sqrt() - self.circle_radius).abs() - self.half_line,
            rectangle(ax, ay, MARK_M / 2.0, MARK_M / 2.0),
            rectangle(from_goal_line + self.mark_distance, ay, MARK_M / 2.0, MARK_M / 2.0),
            if self.goal_areas[usize::from(x > 0.0)] {
                area(self.area_depth, self.area_half_width)
            } else {
                f32::INFINITY
            },
            self.penalty_area.map_or(f32::INFINITY, |[depth, half_width]| area(depth, half_width)),
        ]
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
