//! The particles on the field from above, and an enlarged inset of them while they lie too close together.

use eframe::egui::{Pos2, Rect, Stroke, StrokeKind, Vec2, vec2};
use glam::DVec2;
use reality_sim_core::{
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
};

use super::{frame::FrameView, settings::Layers};
use crate::{colors, field_view::FieldCanvas};

/// Widths of the ground that the inset may show, metres: the smallest that holds the particles.
const WIDTHS_M: [f64; 3] = [0.06, 0.12, 0.3];
/// Share of a smaller width that the particles may take up for the inset to be enlarged further: without it, a cloud as wide
/// as the inset would make it change with every picture.
const SHARE_OF_SMALLER: f64 = 0.7;
/// Width of the inset on the screen, as a share of the view's smaller side, and its range, points.
const WIDTH_SHARE: f32 = 0.4;
const WIDTHS: std::ops::RangeInclusive<f32> = 90.0..=220.0;
/// Distance of the inset from the view's edges, points.
const MARGIN: f32 = 8.0;
/// Least factor by which the inset enlarges the map: below it, the map itself is enlarged.
const LEAST_ENLARGEMENT: f32 = 2.0;
/// Least width of the square around the place on the map, points.
const LEAST_PLACE: f32 = 8.0;
/// Least share of the particles that lie in the inset.
const LEAST_SHARE: f64 = 0.9;
/// Distance that the inset keeps from poses, points.
const DISTANCE: f32 = 12.0;

/// Length of the arrows as a share of the inset's width; the truth's is longer, so that it is seen under the other.
const ARROW_SHARE: f32 = 0.17;
const TRUTH_ARROW_SHARE: f32 = 0.26;

/// Corner of the view, as the direction from its centre.
type Corner = Vec2;

/// Corners in the order in which they are tried: scale and hints are along the lower edge.
const CORNERS: [Corner; 4] = [vec2(1.0, -1.0), vec2(-1.0, -1.0), vec2(1.0, 1.0), vec2(-1.0, 1.0)];

/// Draws the particles: brighter and larger with more weight.
pub fn draw(canvas: &FieldCanvas, frame: &FrameView) {
    for particle in &frame.particles {
        let shown = particle.relative_weight.sqrt();
        let color = colors::PARTICLE.gamma_multiply(0.25 + 0.75 * shown);
        canvas.painter.circle_filled(canvas.at(particle.pose.position_in_world()), 1.2 + 1.6 * shown, color);
    }
}

/// Enlarged view of the particles. It stays in its corner until a pose comes there, and keeps its scale while it can.
#[derive(Debug)]
pub struct Inset {
    corner: Corner,
    width_m: f64,
}

impl Default for Inset {
    fn default() -> Self {
        Self { corner: CORNERS[0], width_m: WIDTHS_M[0] }
    }
}

impl Inset {
    /// Draws the inset into a corner of the map, unless the map itself shows the particles well.
    pub fn draw(&mut self, map: &FieldCanvas, field: &FieldDimensions, frame: &FrameView, layers: &Layers) {
        let middle_in_world = frame.record.pose.planar().position_in_world();
        let width = (WIDTH_SHARE * map.rect.size().min_elem()).clamp(*WIDTHS.start(), *WIDTHS.end());
        let extent_m = extent_m(frame, middle_in_world);
        let Some(width_m) = ground_width_m(self.width_m, extent_m).filter(|_| frame.has_pose()) else {
            return;
        };
        self.width_m = width_m;
        if width < LEAST_ENLARGEMENT * map.points(width_m) {
            return;
        }
        let poses = [Some(frame.record.pose), frame.truth].into_iter().flatten().map(CameraPose::planar);
        let taken: Vec<Pos2> = poses.flat_map(|pose| ends_of_arrow(map, pose)).collect();
        self.corner = free_corner(self.corner, map.rect, width, &taken);
        let rect = in_corner(self.corner, map.rect, width);
        let place_width = map.points(width_m).max(LEAST_PLACE);
        let place = Rect::from_center_size(map.at(middle_in_world), Vec2::splat(place_width));
        draw_frame(map, place, rect);
        let part = map.part(rect, middle_in_world, width_m);
        part.painter.rect_filled(rect, 0.0, colors::CARPET);
        part.draw_lines(field, colors::LINE.gamma_multiply(0.5));
        if layers.particles {
            draw(&part, frame);
        }
        if let Some(truth) = frame.truth.filter(|_| layers.truth) {
            part.arrow_of_length(truth.planar(), colors::TRUTH, TRUTH_ARROW_SHARE * width);
        }
        if layers.best_particle {
            part.arrow_of_length(frame.best_particle.planar(), colors::PARTICLE, ARROW_SHARE * width);
        }
        part.arrow_of_length(frame.record.pose.planar(), colors::POSE, ARROW_SHARE * width);
        part.draw_scale_with("");
        map.painter.rect_stroke(rect, 0.0, stroke(), StrokeKind::Outside);
    }
}

fn stroke() -> Stroke {
    Stroke::new(1.0, colors::LINE.gamma_multiply(0.8))
}

/// Returns the width of the smallest square around a position that holds nearly all particles, metres.
fn extent_m(frame: &FrameView, middle_in_world: DVec2) -> f64 {
    let from_middle = |place: DVec2| (place - middle_in_world).abs().max_element();
    let poses = frame.particles.iter().map(|particle| particle.pose.position_in_world());
    let mut distances_m: Vec<f64> = poses.map(from_middle).collect();
    distances_m.sort_by(f64::total_cmp);
    let last = (LEAST_SHARE * distances_m.len() as f64).ceil() as usize;
    last.checked_sub(1).and_then(|last| distances_m.get(last)).map_or(f64::INFINITY, |half_m| 2.0 * half_m)
}

/// Returns the width of the ground to be shown for particles of this extent, metres; `None` if they are spread too far.
fn ground_width_m(present_m: f64, extent_m: f64) -> Option<f64> {
    let holds =
        |width_m: &f64| extent_m <= if *width_m < present_m { SHARE_OF_SMALLER * width_m } else { *width_m };
    WIDTHS_M.into_iter().find(holds)
}

fn ends_of_arrow(map: &FieldCanvas, pose: Pose2) -> [Pos2; 2] {
    [map.at(pose.position_in_world()), map.arrow_tip(pose)]
}

/// Returns the first corner, beginning with the present one, in which the inset covers none of the positions; the present
/// one if there is none.
fn free_corner(present: Corner, view: Rect, width: f32, taken: &[Pos2]) -> Corner {
    let is_free = |corner: &Corner| {
        let rect = in_corner(*corner, view, width).expand(DISTANCE);
        !taken.iter().any(|position| rect.contains(*position))
    };
    std::iter::once(present).chain(CORNERS).find(is_free).unwrap_or(present)
}

fn in_corner(corner: Corner, view: Rect, width: f32) -> Rect {
    let offset = 0.5 * view.size() - Vec2::splat(MARGIN + 0.5 * width);
    Rect::from_center_size(view.center() + offset * corner, Vec2::splat(width))
}

/// Draws a square around the place on the map that the inset shows, and lines between the two.
fn draw_frame(map: &FieldCanvas, place: Rect, inset: Rect) {
    map.painter.rect_stroke(place, 0.0, stroke(), StrokeKind::Outside);
    let corners = |rect: Rect| [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()];
    // The two lines that enclose all others begin at the corners farthest to both sides of the way to the inset.
    let way = inset.center() - place.center();
    let is_rising = way.x * way.y < 0.0;
    let (from, to) = (corners(place), corners(inset));
    for corner in if is_rising { [0, 2] } else { [1, 3] } {
        let line = Stroke::new(1.0, colors::LINE.gamma_multiply(0.35));
        map.painter.line_segment([from[corner], to[corner]], line);
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;

    use super::*;

    const VIEW: Rect = Rect { min: pos2(100.0, 50.0), max: pos2(700.0, 450.0) };
    const WIDTH: f32 = 150.0;

    fn corner(present: Corner, taken: &[Pos2]) -> Corner {
        free_corner(present, VIEW, WIDTH, taken)
    }

    #[test]
    fn the_inset_stays_in_its_corner_until_a_pose_comes_there() {
        let [right, left, ..] = CORNERS;
        assert_eq!(corner(right, &[VIEW.center()]), right);
        assert_eq!(corner(right, &[pos2(600.0, 100.0)]), left);
        assert_eq!(corner(left, &[VIEW.center()]), left);
        assert_eq!(corner(left, &[pos2(200.0, 100.0)]), right);
    }

    #[test]
    fn the_scale_follows_the_particles_but_not_every_tremor() {
        let [small, middle, large] = WIDTHS_M;
        assert_eq!(ground_width_m(small, 0.99 * small), Some(small));
        assert_eq!(ground_width_m(small, 1.01 * small), Some(middle));
        assert_eq!(ground_width_m(middle, 0.99 * small), Some(middle));
        assert_eq!(ground_width_m(middle, 0.6 * small), Some(small));
        assert_eq!(ground_width_m(small, 0.99 * large), Some(large));
        assert_eq!(ground_width_m(large, 1.01 * large), None);
    }

    #[test]
    fn wherever_two_poses_are_the_inset_covers_neither_and_lies_in_the_view() {
        let places: Vec<Pos2> =
            (0..=12).flat_map(|x| (0..=8).map(move |y| VIEW.min + 50.0 * vec2(x as f32, y as f32))).collect();
        for &a in &places {
            for &b in &places {
                let rect = in_corner(corner(CORNERS[0], &[a, b]), VIEW, WIDTH);
                assert!(VIEW.contains_rect(rect) && !rect.contains(a) && !rect.contains(b), "{a} {b}");
            }
        }
    }
}
