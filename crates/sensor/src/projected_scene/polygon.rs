//! Rays in which a convex outline is visible.

use std::mem;

use glam::{DMat3, DVec3, Vec2, Vec3};

use super::side::Side;
use crate::lens::RayPatch;

/// Largest number of corners of a patch after clipping by every edge of the largest outline, a post's.
const MAX_CORNERS: usize = 32;

/// Rays between the planes through the projection centre and an outline's edges.
#[derive(Debug, Clone)]
pub(super) struct Polygon {
    /// Unit normals of the planes, pointing inwards, in the camera frame.
    normals: Vec<Vec3>,
}

impl Polygon {
    /// Builds the planes from an outline's corners, in order, for a camera position. `None` for an outline without area.
    pub(super) fn new(corners: &[DVec3], position: DVec3, camera_from_world: DMat3) -> Option<Self> {
        let corner = |index: usize| corners[index % corners.len()] - position;
        let middle: DVec3 = (0..corners.len()).map(corner).sum();
        let normal = |index| {
            let plane = corner(index).cross(corner(index + 1)).try_normalize()?;
            Some((camera_from_world * (plane * plane.dot(middle).signum())).as_vec3())
        };
        (0..corners.len()).map(normal).collect::<Option<_>>().map(|normals| Self { normals })
    }

    pub(super) fn side(&self, patch: &RayPatch) -> Side {
        let mut side = Side::Inside;
        for normal in &self.normals {
            let edge = Edge::new(*normal, patch);
            if edge.middle <= -edge.reach() {
                return Side::Outside;
            }
            if edge.middle < edge.reach() {
                side = Side::Edge;
            }
        }
        side
    }

    /// Returns the fraction of a patch inside: the area left after clipping by every edge.
    pub(super) fn coverage(&self, patch: &RayPatch) -> f32 {
        let mut rest = ClippedSquare::new();
        for normal in &self.normals {
            let edge = Edge::new(*normal, patch);
            if edge.middle <= -edge.reach() {
                return 0.0;
            }
            if edge.middle < edge.reach() {
                rest = rest.clipped(&edge);
            }
        }
        rest.area()
    }
}

/// Plane in the coordinates of a patch: inside, `middle + change · (x, y)` is positive.
struct Edge {
    middle: f32,
    change: Vec2,
}

impl Edge {
    fn new(normal: Vec3, patch: &RayPatch) -> Self {
        let change = Vec2::new(normal.dot(patch.across), normal.dot(patch.down));
        Self { middle: normal.dot(patch.center), change }
    }

    /// Returns the largest change from the middle to a corner.
    fn reach(&self) -> f32 {
        0.5 * (self.change.x.abs() + self.change.y.abs())
    }

    fn at(&self, place: Vec2) -> f32 {
        self.middle + self.change.dot(place)
    }
}

/// Clipped part of the unit square around 0 (Sutherland and Hodgman, "Reentrant polygon clipping", 1974).
struct ClippedSquare {
    corners: [Vec2; MAX_CORNERS],
    count: usize,
}

impl ClippedSquare {
    fn new() -> Self {
        let mut square = Self { corners: [Vec2::ZERO; MAX_CORNERS], count: 0 };
        for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
            square.push(Vec2::new(x, y));
        }
        square
    }

    fn push(&mut self, corner: Vec2) {
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[Vec2] {
        &self.corners[..self.count]
    }

    fn clipped(&self, edge: &Edge) -> Self {
        let mut rest = Self { count: 0, ..*self };
        let Some(&last) = self.corners().last() else { return rest };
        let mut before = (last, edge.at(last));
        for &corner in self.corners() {
            let (previous, previous_value) = mem::replace(&mut before, (corner, edge.at(corner)));
            let value = before.1;
            if (value > 0.0) != (previous_value > 0.0) {
                rest.push(previous.lerp(corner, previous_value / (previous_value - value)));
            }
            if value > 0.0 {
                rest.push(corner);
            }
        }
        rest
    }

    fn area(&self) -> f32 {
        let next = self.corners().iter().cycle().skip(1);
        let doubled: f32 = self.corners().iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
        0.5 * doubled.abs()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn area_left_by_two_edges_is_the_fraction_of_points_inside_both(
            edges in proptest::array::uniform2((-0.8f32..0.8, -1.0f32..1.0, -1.0f32..1.0)),
        ) {
            let edges = edges.map(|(middle, a, b)| Edge { middle, change: Vec2::new(a, b) });
            let rest = edges.iter().fold(ClippedSquare::new(), |rest, edge| rest.clipped(edge));
            let offset = |i: u16| (f32::from(i) + 0.5) / 200.0 - 0.5;
            let points = (0..200).flat_map(|i| (0..200).map(move |j| Vec2::new(offset(i), offset(j))));
            let inside = points.filter(|point| edges.iter().all(|edge| edge.at(*point) > 0.0)).count();
            prop_assert!((rest.area() - inside as f32 / 40_000.0).abs() < 0.01);
        }
    }
}
