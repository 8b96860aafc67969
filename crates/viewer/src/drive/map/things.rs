//! Things on the field from above: ball and robots.

use eframe::egui::{Align2, Color32, FontId, Pos2, Stroke, Vec2, vec2};
use reality_sim_core::pose::Pose2;

use super::super::things::{PlacedThing, Thing};
use crate::{colors, field_view::FieldCanvas};

/// Radii of ball and robots, metres, and the least ones on the screen, points.
const BALL: (f64, f32) = (0.065, 4.5);
const ROBOT: (f64, f32) = (0.15, 7.0);
/// Distance of the handle that turns a robot from the robot's middle, points.
const HANDLE: f32 = 24.0;

/// Returns the colour of a thing.
pub fn thing_color(thing: Thing) -> Color32 {
    let [red, green, blue] = thing.srgb();
    Color32::from_rgb(red, green, blue)
}

/// Returns the screen position of the handle that turns a robot.
pub fn handle(canvas: &FieldCanvas, place: Pose2) -> Pos2 {
    canvas.at(place.position_in_world()) + HANDLE * heading(place)
}

fn heading(place: Pose2) -> Vec2 {
    vec2(place.yaw_rad.cos() as f32, -place.yaw_rad.sin() as f32)
}

/// Draws the things, with a ring around the chosen one.
pub fn draw_things(canvas: &FieldCanvas, things: &[PlacedThing], chosen: Option<Thing>) {
    // The ball lies at the robots' feet: it is drawn last, so that it can be seen.
    for placed in things.iter().rev() {
        draw_thing(canvas, placed, chosen == Some(placed.thing));
    }
}

fn draw_thing(canvas: &FieldCanvas, placed: &PlacedThing, is_chosen: bool) {
    let PlacedThing { thing, place } = *placed;
    let (at, color) = (canvas.at(place.position_in_world()), thing_color(thing));
    let (radius_m, least) = if thing == Thing::Ball { BALL } else { ROBOT };
    let radius = canvas.points(radius_m).max(least);
    if thing != Thing::Ball {
        let end = handle(canvas, place);
        for stroke in [Stroke::new(4.5, Color32::from_black_alpha(150)), Stroke::new(2.0, colors::LINE)] {
            canvas.painter.line_segment([at, end], stroke);
        }
        canvas.painter.circle(end, 3.5, color, Stroke::new(1.2, colors::LINE));
        // The name is on the side away from the line.
        let down = heading(place).y > 0.0;
        let (align, side) = if down { (Align2::CENTER_BOTTOM, -1.0) } else { (Align2::CENTER_TOP, 1.0) };
        let corner = at + vec2(0.0, side * (radius + 3.0));
        canvas.painter.text(corner, align, thing.name(), FontId::proportional(10.0), colors::LINE);
    }
    canvas.painter.circle(at, radius, color, Stroke::new(1.2, colors::LINE));
    if is_chosen {
        canvas.painter.circle_stroke(at, radius + 3.0, Stroke::new(1.5, Color32::WHITE));
    }
}
