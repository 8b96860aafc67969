//! Lines and crossings in pixels.

use std::cell::LazyCell;

use glam::DVec2;
use rayon::prelude::*;
use reality_sim_core::{
    camera::Camera,
    field::{Crossing, Curve, LineKind},
    pose::CameraPose,
};

use super::record::{SeenCrossing, SeenLine};

/// Distance on the ground between points at which a line is looked at first, metres: shorter parts that come into view between
/// two hidden points are lost.
const STEP_M: f64 = 0.05;
/// Maximum number of these steps for the longest lines, so that large fields take no longer.
const MOST_STEPS: f64 = 200.0;
/// Maximum distance of neighbouring points in the picture between which a hidden part is not looked for, pixels.
const MAX_STEP_PX: f64 = 12.0;
/// Distance of neighbouring points in the picture that are taken to be joined by a straight line, pixels.
const SHORT_PX: f64 = 1.0;
/// Maximum number of times that a step is halved, for the end of a line in view and for points between two others: a step of 5 cm
/// becomes 0.2 mm.
const MOST_HALVINGS: u32 = 8;
/// Maximum distance of a line from the straight lines that stand for it, pixels: a ninth of how far the lines
/// of recorded pictures lie from their places (docs/reconstruction.md).
const STRAIGHT_PX: f64 = 0.05;

/// Camera at its pose, and what it sees in front of the ground.
pub(super) struct Sight<'a, Hidden> {
    pub(super) camera: &'a Camera,
    pub(super) pose: CameraPose,
    /// Returns whether something stands before the ground at a pixel of the picture.
    pub(super) is_hidden: Hidden,
}

impl<Hidden: Fn(DVec2) -> bool + Sync> Sight<'_, Hidden> {
    /// Returns the parts of lines that are in view.
    pub(super) fn lines(&self, lines: &[(LineKind, Curve)]) -> Vec<SeenLine> {
        let seen = lines.par_iter().enumerate().flat_map_iter(|(line, (kind, curve))| {
            let parts = self.parts(curve).into_iter().filter(|pixels| pixels.len() > 1);
            parts.map(move |pixels| SeenLine { kind: *kind, line, pixels: straightened(&pixels) })
        });
        seen.collect()
    }

    /// Returns all crossings with the pixels at which they are.
    pub(super) fn crossings(&self, crossings: &[Crossing]) -> Vec<SeenCrossing> {
        let seen = |crossing: &Crossing| {
            let pixel = self.pixel(crossing.point_in_world);
            let is_visible = pixel.is_some_and(|pixel| !(self.is_hidden)(pixel));
            SeenCrossing { crossing: *crossing, pixel, is_visible }
        };
        crossings.iter().map(seen).collect()
    }

    fn pixel(&self, ground: DVec2) -> Option<DVec2> {
        self.camera.project(self.pose.camera_from_world(ground.extend(0.0))).ok()
    }

    fn visible(&self, curve: &Curve, fraction: f64) -> Option<DVec2> {
        self.pixel(curve.at(fraction).0).filter(|pixel| !(self.is_hidden)(*pixel))
    }

    /// Returns the visible parts of a curve as polylines, pixels.
    fn parts(&self, curve: &Curve) -> Vec<Vec<DVec2>> {
        let steps = (curve.length_m() / STEP_M).ceil().clamp(1.0, MOST_STEPS) as usize;
        let mut parts = Parts { done: Vec::new(), open: Vec::new() };
        let mut before = (0.0, self.visible(curve, 0.0));
        parts.open.extend(before.1);
        for step in 1..=steps {
            let fraction = step as f64 / steps as f64;
            let now = (fraction, self.visible(curve, fraction));
            self.follow(curve, [before, now], 0, &mut parts);
            before = now;
        }
        parts.end();
        parts.done
    }

    /// Follows a curve from one of its points to the next.
    fn follow(&self, curve: &Curve, [from, to]: [(f64, Option<DVec2>); 2], halvings: u32, parts: &mut Parts) {
        let fraction = 0.5 * (from.0 + to.0);
        let middle = LazyCell::new(|| (fraction, self.visible(curve, fraction)));
        let is_short = match (from.1, to.1) {
            (Some(a), Some(b)) if a.distance(b) <= SHORT_PX => true,
            (Some(from), Some(to)) if from.distance(to) <= MAX_STEP_PX => {
                let chord = Curve::Segment { from, to };
                middle.1.is_some_and(|middle| chord.distance_m(middle) <= STRAIGHT_PX / 2.0)
            }
            (None, None) => true,
            _ => false,
        };
        if is_short || halvings == MOST_HALVINGS {
            match to.1 {
                Some(pixel) => parts.open.push(pixel),
                None => parts.end(),
            }
            return;
        }
        let middle = *middle;
        self.follow(curve, [from, middle], halvings + 1, parts);
        self.follow(curve, [middle, to], halvings + 1, parts);
    }
}

/// Parts of a line that were followed to their ends, and the one that goes on.
struct Parts {
    done: Vec<Vec<DVec2>>,
    open: Vec<DVec2>,
}

impl Parts {
    fn end(&mut self) {
        let part = std::mem::take(&mut self.open);
        if !part.is_empty() {
            self.done.push(part);
        }
    }
}

/// Leaves out points that the straight lines between the others tell (Douglas and Peucker, 1973).
fn straightened(points: &[DVec2]) -> Vec<DVec2> {
    let mut is_kept = vec![false; points.len()];
    let mut open = vec![(0, points.len() - 1)];
    while let Some((first, last)) = open.pop() {
        (is_kept[first], is_kept[last]) = (true, true);
        let side = Curve::Segment { from: points[first], to: points[last] };
        let farthest = (first + 1..last)
            .map(|index| (index, side.distance_m(points[index])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((index, _)) = farthest.filter(|(_, distance_px)| *distance_px > STRAIGHT_PX) {
            open.extend([(first, index), (index, last)]);
        }
    }
    points.iter().zip(is_kept).filter_map(|(point, is_kept)| is_kept.then_some(*point)).collect()
}
