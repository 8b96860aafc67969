//! White lines and marks on the ground, without overlaps, so that the fractions of a pixel that they cover add up.

use glam::{DVec2, DVec3};
use reality_sim_core::field::{Curve, FieldDimensions, MARK_HALF_SIDE_M};

use super::shape::Shape;

/// Rectangle along the world's axes, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    min: DVec2,
    max: DVec2,
}

impl Rectangle {
    pub(super) fn around(center: DVec2, half_extent_m: DVec2) -> Self {
        Self { min: center - half_extent_m, max: center + half_extent_m }
    }

    /// Returns the rectangle grown by this much on every side.
    pub(super) fn grown(self, by_m: f64) -> Self {
        Self { min: self.min - by_m, max: self.max + by_m }
    }

    pub(super) fn at_height(self, z_m: f64) -> Shape {
        let Self { min, max } = self;
        let corners = [(min.x, min.y), (max.x, min.y), (max.x, max.y), (min.x, max.y)];
        Shape::Polygon(corners.map(|(x, y)| DVec3::new(x, y, z_m)).to_vec())
    }

    fn has_area(&self) -> bool {
        self.min.cmplt(self.max).all()
    }

    /// Returns the difference from another rectangle: up to four rectangles around it.
    fn without(self, other: Self) -> Vec<Self> {
        let common = Self { min: self.min.max(other.min), max: self.max.min(other.max) };
        if !common.has_area() {
            return vec![self];
        }
        let pieces = [
            Self { max: DVec2::new(common.min.x, self.max.y), ..self },
            Self { min: DVec2::new(common.max.x, self.min.y), ..self },
            Self { min: DVec2::new(common.min.x, self.min.y), max: DVec2::new(common.max.x, common.min.y) },
            Self { min: DVec2::new(common.min.x, common.max.y), max: DVec2::new(common.max.x, self.max.y) },
        ];
        pieces.into_iter().filter(Self::has_area).collect()
    }
}

/// Returns the field's straight lines, which run along its axes, and its marks. Lines meet at their centres: each is
/// extended by half a width at both ends, so that corners are square.
pub(super) fn straight_lines(field: &FieldDimensions) -> Vec<Shape> {
    let half_width_m = field.line_width_m / 2.0;
    let line = |curve: &Curve| match curve {
        Curve::Segment { from, to } => {
            Some(Rectangle { min: from.min(*to), max: from.max(*to) }.grown(half_width_m))
        }
        Curve::Circle { .. } => None,
    };
    let mark = |center| Rectangle::around(center, DVec2::splat(MARK_HALF_SIDE_M));
    let all = field.curves().iter().filter_map(line).chain(field.marks().map(mark)).collect::<Vec<_>>();
    without_overlaps(&all).into_iter().map(|rectangle| rectangle.at_height(0.0)).collect()
}

/// Returns the field's circular lines.
pub(super) fn circles(field: &FieldDimensions) -> Vec<Shape> {
    let half_width_m = field.line_width_m / 2.0;
    let circle = |curve: Curve| match curve {
        Curve::Circle { center, radius_m } => Some(Shape::Ring {
            center: center.extend(0.0),
            inner_m: radius_m - half_width_m,
            outer_m: radius_m + half_width_m,
        }),
        Curve::Segment { .. } => None,
    };
    field.curves().into_iter().filter_map(circle).collect()
}

fn without_overlaps(rectangles: &[Rectangle]) -> Vec<Rectangle> {
    let mut apart: Vec<Rectangle> = Vec::new();
    for rectangle in rectangles {
        let mut pieces = vec![*rectangle];
        for other in &apart {
            pieces = pieces.into_iter().flat_map(|piece| piece.without(*other)).collect();
        }
        apart.append(&mut pieces);
    }
    apart
}
