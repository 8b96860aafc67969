//! Cuts triangles until the lens leaves their sides straight, and drops what the lens does not see.

use glam::{DVec3, Vec3};

use super::screen::{Corner, ScreenTriangle};
use crate::view::{Instant, View};

/// Largest distance of a side's middle from where a straight side has it, pixels: far below what edges show.
const LARGEST_BEND_PX: f64 = 0.05;
/// Length of a side that no lens bends that much, pixels: the picture of a straight line has a radius of at least a focal
/// length or so, and those of lenses worth the name are above a hundred pixels: 4² / (8 · 100) = 0.02.
const STRAIGHT_PX: f64 = 4.0;
/// Largest error of a distance between corners, as a part of it.
const LARGEST_DISTANCE_ERROR: f64 = 0.01;
/// Number of times that a triangle may be cut: what is dropped at the lens's rim is then at most a sixty-fourth of its size.
const MOST_CUTS: u32 = 6;
/// A triangle none of whose corners is seen may still be seen if its sides are as long as this part of its distance.
const WIDE: f64 = 0.5;

/// Point of a triangle: place in the world, colour, and corner in the picture where the lens sees it.
pub(crate) type Point = (DVec3, Vec3, Option<Corner>);

/// Camera at one instant of a picture of something that moves.
#[derive(Debug)]
pub(crate) struct Clipper<'a> {
    pub(crate) view: &'a View<'a>,
    pub(crate) instant: Instant,
    pub(crate) velocity: DVec3,
}

impl Clipper<'_> {
    /// Projects a point of the mesh.
    pub(crate) fn corner(&self, place: DVec3, color: Vec3) -> Option<Corner> {
        let seen = self.view.project_at(&self.instant, place, self.velocity)?;
        Some(Corner { pixel: seen.pixel, distance_m: seen.distance_m, color })
    }

    /// Adds what is seen of a triangle.
    pub(crate) fn put(&self, points: [Point; 3], triangles: &mut Vec<ScreenTriangle>) {
        self.put_part(points, MOST_CUTS, triangles);
    }

    fn put_part(&self, points: [Point; 3], cuts: u32, triangles: &mut Vec<ScreenTriangle>) {
        let [a, b, c] = points;
        let sides = [(a, b), (b, c), (c, a)];
        let middles = if cuts == 0 { [None; 3] } else { sides.map(|(from, to)| self.cut(from, to)) };
        if cuts > 0 && self.is_hopeless(&points) {
            return;
        }
        let mut put = |points| self.put_part(points, cuts - 1, triangles);
        match middles {
            [None, None, None] => {
                if let [Some(a), Some(b), Some(c)] = points.map(|(.., corner)| corner) {
                    triangles.push(ScreenTriangle { corners: [a, b, c] });
                }
            }
            [Some(ab), Some(bc), Some(ca)] => {
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].into_iter().for_each(put);
            }
            [Some(ab), Some(bc), None] => [[a, ab, c], [ab, b, bc], [ab, bc, c]].into_iter().for_each(put),
            [None, Some(bc), Some(ca)] => [[a, b, bc], [a, bc, ca], [ca, bc, c]].into_iter().for_each(put),
            [Some(ab), None, Some(ca)] => [[a, ab, ca], [ab, b, c], [ab, c, ca]].into_iter().for_each(put),
            [Some(ab), None, None] => [[a, ab, c], [ab, b, c]].into_iter().for_each(put),
            [None, Some(bc), None] => [[a, b, bc], [a, bc, c]].into_iter().for_each(put),
            [None, None, Some(ca)] => [[a, b, ca], [ca, b, c]].into_iter().for_each(&mut put),
        }
    }

    /// Returns the middle of a side that has to be cut: because it is bent, or because the lens sees one end at most. Both
    /// triangles at a side decide alike.
    fn cut(&self, from: Point, to: Point) -> Option<Point> {
        let middle = || {
            let (place, color) = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
            (place, color, self.corner(place, color))
        };
        let (Some(a), Some(b)) = (from.2, to.2) else { return Some(middle()) };
        let distances = [a.distance_m, b.distance_m];
        let ratio = distances[0].max(distances[1]) / distances[0].min(distances[1]);
        if a.pixel.distance(b.pixel) < STRAIGHT_PX && ratio < 1.0 + LARGEST_DISTANCE_ERROR {
            return None;
        }
        let middle = middle();
        let is_straight = middle.2.is_some_and(|seen| {
            let distance_m = 0.5 * (a.distance_m + b.distance_m);
            seen.pixel.distance(0.5 * (a.pixel + b.pixel)) <= LARGEST_BEND_PX
                && (seen.distance_m - distance_m).abs() <= LARGEST_DISTANCE_ERROR * distance_m
        });
        (!is_straight).then_some(middle)
    }

    /// Whether the lens sees no corner of a triangle, nor anything between them.
    fn is_hopeless(&self, points: &[Point; 3]) -> bool {
        if points.iter().any(|(.., corner)| corner.is_some()) {
            return false;
        }
        let [a, b, c] = points.map(|(place, ..)| place);
        let longest_m = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let position = self.view.pose().position_in_world();
        let nearest_m =
            [a, b, c].map(|place| place.distance(position)).into_iter().fold(f64::INFINITY, f64::min);
        // Nothing is seen of places that are not numbers.
        longest_m.is_nan() || longest_m <= WIDE * nearest_m
    }
}
