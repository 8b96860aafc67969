//! Hand that moves things in the camera's pictures, with the mouse.

use eframe::egui::{CursorIcon, PointerButton, Pos2, Ui};
use glam::DVec2;
use reality_sim_core::{camera::Camera, pose::CameraPose};

use super::{
    kind::Pane,
    staging::SeenThing,
    things::{Gesture, Thing, Things},
};
use crate::picture_view::PictureCanvas;

/// Distance from a thing's box within which it can be grabbed, pixels: a ball far away is small.
const CATCH_PX: f64 = 4.0;
/// Angle by which a robot turns for each point that the wheel scrolls, radians: a quarter turn takes six notches of 50 points.
const TURN_RAD_PER_POINT: f32 = 0.005;

/// Picture on the screen, with the things in it.
#[derive(Debug, Clone, Copy)]
pub struct Touched<'a> {
    pub pane: Pane,
    pub camera: &'a Camera,
    /// Pose at which the picture was taken.
    pub pose: CameraPose,
    /// Things as the picture shows them, and all that are there now.
    pub seen: &'a [SeenThing],
    pub things: &'a Things,
}

/// Hand, and what it holds.
#[derive(Debug, Default)]
pub struct Hand(Option<Held>);

/// Thing that is being dragged in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    pane: Pane,
    thing: Thing,
    /// From the pointer to where the thing stands on the ground, pixels.
    offset_px: DVec2,
}

impl Hand {
    /// Whether the hand holds something.
    pub fn is_holding(&self) -> bool {
        self.0.is_some()
    }

    /// Returns the pane in which something is held.
    pub fn pane(&self) -> Option<Pane> {
        self.0.map(|held| held.pane)
    }

    /// Lets go when no button is held: a drag may end while its picture is not shown.
    pub fn rest(&mut self, ui: &Ui) {
        if !ui.input(|input| input.pointer.any_down()) {
            self.0 = None;
        }
    }

    /// Lets the mouse take, move and turn things in a picture; returns what it does to one of them.
    pub fn touch(&mut self, ui: &Ui, canvas: &PictureCanvas, touched: &Touched) -> Option<Gesture> {
        let response = &canvas.response;
        if response.drag_started_by(PointerButton::Primary) {
            let origin = ui.input(|input| input.pointer.press_origin());
            self.0 = origin.and_then(|at| touched.grab(canvas, at));
        }
        if let Some(held) = self.0.filter(|held| held.pane == touched.pane) {
            ui.set_cursor_icon(CursorIcon::Grabbing);
            let at = response.interact_pointer_pos()?;
            let place = touched.ground(canvas.pixel_at(at) + held.offset_px)?;
            return Some(Gesture::MoveTo(held.thing, place));
        }
        let thing = response.hover_pos().and_then(|at| touched.thing_at(canvas.pixel_at(at)))?.placed.thing;
        if !self.is_holding() && !response.dragged() {
            ui.set_cursor_icon(CursorIcon::Grab);
        }
        let scrolled = ui.input(|input| input.smooth_scroll_delta().y);
        match thing {
            Thing::Robot(_) if scrolled != 0.0 => {
                Some(Gesture::TurnBy(thing, f64::from(TURN_RAD_PER_POINT * scrolled)))
            }
            _ => response.clicked().then_some(Gesture::Choose(thing)),
        }
    }
}

impl Touched<'_> {
    /// Returns the thing at a pixel; of several, the one with the smallest box.
    pub fn thing_at(&self, pixel: DVec2) -> Option<&SeenThing> {
        let around = |seen: &SeenThing| {
            let Some(visible) = seen.visible else { return false };
            let [left, top, right, bottom] =
                [visible.left, visible.top, visible.right, visible.bottom].map(f64::from);
            (left - CATCH_PX..=right + CATCH_PX).contains(&pixel.x)
                && (top - CATCH_PX..=bottom + CATCH_PX).contains(&pixel.y)
        };
        let area = |seen: &&SeenThing| {
            seen.visible.map_or(0, |visible| u64::from(visible.width()) * u64::from(visible.height()))
        };
        self.seen.iter().filter(|seen| around(seen)).min_by_key(area)
    }

    fn grab(&self, canvas: &PictureCanvas, at: Pos2) -> Option<Held> {
        let pixel = canvas.pixel_at(at);
        let placed = self.thing_at(pixel)?.placed;
        let foot_in_camera = self.pose.camera_from_world(placed.place.position_in_world().extend(0.0));
        let foot = self.camera.project_unbounded(foot_in_camera).unwrap_or(pixel);
        Some(Held { pane: self.pane, thing: placed.thing, offset_px: foot - pixel })
    }

    /// Returns the place on the ground that a pixel shows; beyond the things' reach, the last one in that direction.
    fn ground(&self, pixel: DVec2) -> Option<DVec2> {
        let place = self.camera.unproject_to_ground(self.pose, pixel).ok()?;
        Some(self.things.within_reach(self.pose.planar().position_in_world(), place))
    }
}
