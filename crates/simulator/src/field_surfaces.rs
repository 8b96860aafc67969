//! Which surface of the field lies at a point of the ground.

use glam::DVec2;
use reality_sim_core::field::{Curve, FieldDimensions};
use reality_sim_sensor::Surface;

/// Distance from the middle of a line up to which a point is on it for sure, in half widths of a line: the rest is for blur
/// and for errors of the pose.
const SURELY_LINE: f64 = 0.5;
/// Distance from lines and from marks beyond which a point is on the carpet for sure, in half widths of a line; marks are larger
/// than lines are wide.
const SURELY_CARPET: [f64; 2] = [3.0, 4.0];

/// Lines and carpet of a field, away from their edges.
#[derive(Debug, Clone)]
pub(crate) struct FieldSurfaces {
    curves: Vec<Curve>,
    marks: [DVec2; 3],
    half_extent_m: DVec2,
    half_width_m: f64,
}

impl FieldSurfaces {
    pub(crate) fn new(field: &FieldDimensions) -> Self {
        Self {
            curves: field.curves(),
            marks: field.marks(),
            half_extent_m: field.carpet_half_extent_m(),
            half_width_m: 0.5 * field.line_width_m,
        }
    }

    /// Returns whether a point of the ground shows a line or carpet; `None` near an edge or a mark, and beyond the carpet.
    pub(crate) fn at(&self, point_in_world: DVec2) -> Option<Surface> {
        if !point_in_world.abs().cmple(self.half_extent_m).all() {
            return None;
        }
        let nearest = |distances: &mut dyn Iterator<Item = f64>| {
            distances.fold(f64::INFINITY, f64::min) / self.half_width_m.max(f64::MIN_POSITIVE)
        };
        let to_line = nearest(&mut self.curves.iter().map(|curve| curve.distance_m(point_in_world)));
        let to_mark = nearest(&mut self.marks.iter().map(|mark| mark.distance(point_in_world)));
        if to_mark <= SURELY_CARPET[1] {
            None
        } else if to_line < SURELY_LINE {
            Some(Surface::Line)
        } else {
            (to_line > SURELY_CARPET[0]).then_some(Surface::Carpet)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_carpet_and_what_is_neither_are_told_apart() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let surfaces = FieldSurfaces::new(&field);
        let at = |x: f64, y: f64| surfaces.at(DVec2::new(x, y));
        assert_eq!(at(1.0, 2.0), Some(Surface::Line));
        assert_eq!(at(1.0, 1.0), Some(Surface::Carpet));
        assert_eq!(at(1.0, 1.96), None, "beside the line");
        assert_eq!(at(0.0, 0.02), None, "the centre mark");
        assert_eq!(at(9.0, 0.0), None, "beyond the carpet");
        assert_eq!(at(f64::NAN, 0.0), None);
    }
}
