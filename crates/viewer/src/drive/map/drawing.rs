//! Drawing of the data around the robot.

use eframe::egui::{Align2, Color32, FontId, Pos2, Shape, Stroke, vec2};
use glam::DVec2;
use reality_sim_core::pose::{CameraPose, Pose2};

use super::{
    super::{answer::Around, edges::Edges, widgets::hue},
    layers::{EDGES, IMAGES, MapContent},
};
use crate::{colors, field_view::FieldCanvas};

/// Largest number of marks: more cannot be distinguished, so only every n-th is drawn.
pub const MOST_MARKS: usize = 3000;
/// Least weight that is written.
const LEAST_WEIGHT: f64 = 0.005;

/// Colour of the drawn path.
const PATH: Color32 = Color32::WHITE;

/// Draws the layers that are switched on.
pub fn draw_known(canvas: &FieldCanvas, content: &MapContent, pose: CameraPose) {
    let MapContent { source, layers, around, used, probes, used_by: _ } = content;
    let poses = source.archive.index().poses();
    if layers.triangulation
        && let Some(around) = around
    {
        draw_triangulation(canvas, &around.edges);
    }
    if layers.probes
        && let Some(probes) = probes
    {
        let all = probes.poses();
        for (_, pose) in all.iter().step_by(all.len().div_ceil(MOST_MARKS).max(1)) {
            draw_probe(canvas, pose.planar());
        }
    }
    if layers.images {
        for pose in poses.iter().step_by(poses.len().div_ceil(MOST_MARKS).max(1)) {
            mark(canvas, pose.planar(), 1.6, IMAGES.gamma_multiply(0.8));
        }
    }
    if layers.neighbours
        && let Some(around) = around
    {
        draw_neighbours(canvas, around, poses, pose);
    }
    if layers.used {
        for (number, image) in used.iter().enumerate().rev() {
            let planar = poses[image.image as usize].planar();
            canvas.painter.circle_filled(canvas.at(planar.position_in_world()), 6.0, Color32::BLACK);
            mark(canvas, planar, 4.5, hue(number));
        }
    }
}

/// Draws a dot with its viewing direction.
fn mark(canvas: &FieldCanvas, planar: Pose2, radius: f32, color: Color32) {
    let at = canvas.at(planar.position_in_world());
    let direction = vec2(planar.yaw_rad.cos() as f32, -planar.yaw_rad.sin() as f32);
    canvas.painter.circle_filled(at, radius, color);
    let end = at + (radius + 5.0) * direction;
    canvas.painter.line_segment([at, end], Stroke::new(0.6 * radius.min(3.0), color));
}

/// Draws a small hollow diamond.
fn draw_probe(canvas: &FieldCanvas, planar: Pose2) {
    let at = canvas.at(planar.position_in_world());
    let corners = [vec2(0.0, -2.5), vec2(2.5, 0.0), vec2(0.0, 2.5), vec2(-2.5, 0.0)];
    let corners = corners.map(|offset| at + offset).to_vec();
    canvas.painter.add(Shape::closed_line(corners, Stroke::new(1.0, colors::TRUTH)));
}

fn draw_triangulation(canvas: &FieldCanvas, sectors: &[Edges]) {
    for sector in sectors {
        let color = EDGES.gamma_multiply(0.25 + 0.6 * sector.share as f32);
        for ends in &sector.shown_in_world {
            canvas.painter.line_segment(ends.map(|end| canvas.at(end)), Stroke::new(1.0, color));
        }
    }
}

fn draw_neighbours(canvas: &FieldCanvas, around: &Around, poses: &[CameraPose], pose: CameraPose) {
    let from = canvas.at(pose.planar().position_in_world());
    let shown = around.natural.iter().filter(|neighbour| neighbour.weight >= LEAST_WEIGHT);
    let mut below = 0.0;
    for neighbour in shown {
        let planar = poses[neighbour.image as usize].planar();
        let at = canvas.at(planar.position_in_world());
        let width = 1.0 + 4.0 * neighbour.weight as f32;
        canvas.painter.line_segment([from, at], Stroke::new(width, Color32::from_white_alpha(150)));
        mark(canvas, planar, 3.0, Color32::WHITE);
        // Text goes to the side away from the robot, where there are no lines.
        // The texts at the robot's feet are stacked.
        let is_here = at.distance(from) < 12.0;
        let aside = if is_here { vec2(0.0, 22.0 + below) } else { 16.0 * (at - from).normalized() };
        below += if is_here { 14.0 } else { 0.0 };
        let text = format!("{:.0} %", 100.0 * neighbour.weight);
        let galley = canvas.painter.layout_no_wrap(text, FontId::proportional(11.0), Color32::WHITE);
        let rect = Align2::CENTER_CENTER.anchor_size(at + aside, galley.size());
        canvas.painter.rect_filled(rect.expand(1.5), 2.0, Color32::from_black_alpha(170));
        canvas.painter.galley(rect.min, galley, Color32::WHITE);
    }
}

/// Writes the coordinates under the pointer.
pub fn write_pointer(canvas: &FieldCanvas) {
    if let Some(pointer) = canvas.response.hover_pos() {
        let place = canvas.in_world(pointer);
        let text = format!("x {:.2} m, y {:.2} m", place.x, place.y);
        let corner = canvas.rect.right_bottom() - vec2(10.0, 10.0);
        let font = FontId::proportional(11.0);
        canvas.painter.text(corner, Align2::RIGHT_BOTTOM, text, font, colors::LINE);
    }
}

/// Draws the path that the robot follows.
pub fn draw_path(canvas: &FieldCanvas, path: &[DVec2]) {
    let points: Vec<Pos2> = path.iter().map(|&place| canvas.at(place)).collect();
    for stroke in [Stroke::new(4.0, Color32::from_black_alpha(140)), Stroke::new(2.0, PATH)] {
        canvas.painter.add(Shape::line(points.clone(), stroke));
    }
    if let [.., last] = &points[..] {
        canvas.painter.circle(*last, 4.0, PATH, Stroke::new(1.0, Color32::BLACK));
    }
}
