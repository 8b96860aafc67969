//! The field from above: the robot and the things to drag, the path to draw, and layers with the data around the robot.

mod coverage;
mod drawing;
mod layers;
mod things;

use std::sync::Arc;

use eframe::egui::{self, Color32, CursorIcon, PointerButton, Pos2, Ui, Vec2, vec2};
use glam::DVec2;
use reality_sim_core::pose::{CameraPose, Pose2};

pub use self::layers::{Layers, MapContent};
use self::{
    coverage::CoverageMap,
    drawing::{MOST_MARKS, draw_known, draw_path, write_pointer},
    layers::{CoverageLayer, EDGES, IMAGES},
    things::{draw_things, handle},
};
use super::{
    answer::Around,
    edges::Region,
    robot::{MARGIN_M, Robot},
    source::Source,
    things::{Gesture, PlacedThing, Thing, Things},
    widgets::{hue, swatch},
};
use crate::{
    colors,
    field_view::{FieldCanvas, FieldView},
    footprint::Footprint,
    problems::Problems,
};

/// Distance from the arrow's ends within which they can be grabbed, points.
const CATCH: f32 = 14.0;
/// Least distance from what is turned at which the pointer has a direction, metres.
const LEAST_ARM_M: f64 = 1e-3;
/// Explanation of the neighbours' layer.
const NEIGHBOURS_MEAN: &str = "The natural neighbours with their weights by where pictures were taken (Sibson, 1981). How many pixels a picture gave in the end is another number: it is below the picture, after “made of”.";

/// Object grabbed with the mouse.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Grip {
    /// The arrow's tail, at this offset from the pointer, metres.
    Move(DVec2),
    /// The arrow's tip.
    Turn,
    /// The path.
    Draw,
    /// A thing, at this offset from the pointer, metres.
    MoveThing(Thing, DVec2),
    /// The end of a robot's line.
    TurnThing(Thing),
}

/// The field from above.
pub struct Map {
    view: FieldView,
    grip: Option<Grip>,
    is_drawing: bool,
    coverage: CoverageMap,
    footprint: Footprint,
    seen: Region,
}

impl Default for Map {
    fn default() -> Self {
        Self {
            view: FieldView::with_margin(MARGIN_M),
            grip: None,
            is_drawing: false,
            coverage: CoverageMap::default(),
            footprint: Footprint::default(),
            seen: [DVec2::ZERO; 2],
        }
    }
}

impl Map {
    /// Shows the field as large as fits into the room, and lets the user drag the robot and the things.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        room: Vec2,
        content: &MapContent,
        robot: &mut Robot,
        things: &mut Things,
    ) {
        let field = content.source.archive.field();
        let extent = 2.0 * (field.carpet_half_extent_m() + MARGIN_M);
        let height = (room.x * (extent.y / extent.x) as f32).min(room.y).max(80.0);
        let canvas = self.view.show(ui, field, vec2(room.x, height), "the field from above");
        self.drag(ui, &canvas, robot, things);
        self.seen = region(&canvas);
        self.coverage.draw(&canvas, content.layers.coverage);
        if content.layers.footprint {
            canvas.footprint(self.footprint.outline(&content.source.archive.setup().camera, robot.pose()));
        }
        draw_known(&canvas, content, robot.pose());
        draw_path(&canvas, robot.path());
        draw_things(&canvas, things.shown(), things.chosen().map(|chosen| chosen.thing));
        canvas.arrow(robot.pose().planar(), colors::POSE);
        write_pointer(&canvas);
    }

    /// Returns the part of the field that was shown last.
    pub fn seen(&self) -> Region {
        self.seen
    }

    /// Follows the path, or stops; dragging then moves the robot.
    pub fn follow_or_stop(&mut self, robot: &mut Robot) {
        self.is_drawing = false;
        robot.follow_or_stop();
    }

    /// Shows the controls for drawing, following and deleting a path.
    pub fn path_ui(&mut self, ui: &mut Ui, robot: &mut Robot) {
        ui.horizontal_wrapped(|ui| {
            ui.toggle_value(&mut self.is_drawing, "Draw a path").on_hover_text(
                "While this is on, dragging on the field draws the path that the robot follows",
            );
            let follow = if robot.is_following() { "Stop" } else { "Follow the path" };
            if ui
                .add_enabled(robot.has_path(), egui::Button::new(follow))
                .on_hover_text("Space")
                .on_disabled_hover_text("Draw a path first")
                .clicked()
            {
                self.follow_or_stop(robot);
            }
            if ui.add_enabled(robot.has_path(), egui::Button::new("Clear the path")).clicked() {
                robot.clear_path();
            }
            if ui.button("Reset").on_hover_text("Back to where the first picture was taken").clicked() {
                robot.reset();
            }
        });
    }

    /// Starts counting the coverage once it is needed.
    pub fn poll(&mut self, ui: &Ui, source: &Arc<Source>, layers: &mut Layers, problems: &mut Problems) {
        self.coverage.poll(ui, source, layers, problems);
    }

    /// Shows a switch for each layer, in its colour.
    pub fn layers_ui(&mut self, ui: &mut Ui, content: &MapContent, layers: &mut Layers) {
        let used_mean = format!(
            "The images that the picture “{}” is made of, in the colours of its origins",
            content.used_by
        );
        ui.horizontal_wrapped(|ui| {
            let boxes: [(&mut bool, &str, Color32, &str); 6] = [
                (&mut layers.images, "recorded", IMAGES, "Where pictures were recorded, and where they look"),
                (&mut layers.used, "in use", hue(0), &used_mean),
                (&mut layers.neighbours, "neighbours", Color32::WHITE, NEIGHBOURS_MEAN),
                (
                    &mut layers.triangulation,
                    "triangulation",
                    EDGES,
                    "The Delaunay triangulation of where pictures were taken in about this direction",
                ),
                (
                    &mut layers.footprint,
                    "ground seen",
                    colors::BORDER,
                    "The ground in the picture, up to 4 m away",
                ),
                (
                    &mut layers.probes,
                    "true pictures",
                    colors::TRUTH,
                    "Where true pictures were taken that are not in the database",
                ),
            ];
            for (is_on, name, color, meaning) in boxes {
                ui.checkbox(is_on, (swatch(color), name)).on_hover_text(meaning);
            }
        });
        if layers.used {
            ui.weak(format!("in use: by the picture “{}”", content.used_by));
        }
        if layers.neighbours {
            ui.weak("neighbours: with their natural neighbour weights, not shares of pixels")
                .on_hover_text(NEIGHBOURS_MEAN);
        }
        edges_ui(ui, layers.triangulation, content.around);
        ui.horizontal_wrapped(|ui| {
            let label = ui.label("Coverage");
            egui::ComboBox::from_id_salt("coverage")
                .width(190.0)
                .selected_text(layers.coverage.name())
                .show_ui(ui, |ui| {
                    for layer in CoverageLayer::ALL {
                        ui.selectable_value(&mut layers.coverage, layer, layer.name());
                    }
                })
                .response
                .labelled_by(label.id);
            self.coverage.legend_ui(ui, layers.coverage);
            if content.layers.images && content.source.archive.images().len() > MOST_MARKS {
                ui.weak("Not every recorded picture is drawn.");
            }
        });
    }

    fn drag(&mut self, ui: &Ui, canvas: &FieldCanvas, robot: &mut Robot, things: &mut Things) {
        let response = &canvas.response;
        let caught = |at: Pos2| self.caught(canvas, robot.pose().planar(), things, at);
        if let Some(grip) = response.hover_pos().and_then(caught) {
            ui.set_cursor_icon(match grip {
                Grip::Draw => CursorIcon::Crosshair,
                Grip::Move(_) | Grip::MoveThing(..) => CursorIcon::Grab,
                Grip::Turn | Grip::TurnThing(_) => CursorIcon::Alias,
            });
        }
        let is_clicked = response.clicked_by(PointerButton::Primary);
        let clicked = response.interact_pointer_pos().filter(|_| is_clicked).and_then(caught);
        let begins = response.drag_started_by(PointerButton::Primary);
        let begun = begins.then(|| ui.input(|input| input.pointer.press_origin()).and_then(caught));
        if let Some(Grip::MoveThing(thing, _) | Grip::TurnThing(thing)) = clicked {
            things.obey(Gesture::Choose(thing));
        }
        if let Some(grip) = begun {
            self.grip = grip;
            if grip == Some(Grip::Draw) {
                robot.clear_path();
            }
        }
        if let (Some(grip), Some(at), true) =
            (self.grip, response.interact_pointer_pos(), response.dragged_by(PointerButton::Primary))
        {
            pull(grip, canvas.in_world(at), robot, things);
        }
        // A drag may also end while the field is not shown.
        if !response.dragged() {
            self.grip = None;
        }
    }

    /// Returns the object that can be grabbed at a position: the nearest within reach.
    fn caught(&self, canvas: &FieldCanvas, planar: Pose2, things: &Things, at: Pos2) -> Option<Grip> {
        if self.is_drawing {
            return Some(Grip::Draw);
        }
        let pointer_in_world = canvas.in_world(at);
        let tail = planar.position_in_world();
        let robot =
            [(canvas.at(tail), Grip::Move(tail - pointer_in_world)), (canvas.arrow_tip(planar), Grip::Turn)];
        let of_thing = |placed: &PlacedThing| {
            let middle = placed.place.position_in_world();
            let grip = Grip::MoveThing(placed.thing, middle - pointer_in_world);
            let turn = (handle(canvas, placed.place), Grip::TurnThing(placed.thing));
            let is_robot = placed.thing != Thing::Ball;
            [Some((canvas.at(middle), grip)), is_robot.then_some(turn)].into_iter().flatten()
        };
        let grips = robot.into_iter().chain(things.shown().iter().flat_map(of_thing));
        let near = grips.map(|(place, grip)| (place.distance(at), grip));
        let near = near.filter(|(distance, _)| *distance <= CATCH);
        near.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, grip)| grip)
    }
}

/// Pulls what is grabbed to a place in the world, metres.
fn pull(grip: Grip, place: DVec2, robot: &mut Robot, things: &mut Things) {
    let pose = robot.pose();
    match grip {
        Grip::Move(offset) => {
            let place = place + offset;
            robot.take(pose.with_planar(Pose2::new(place.x, place.y, pose.yaw_rad)));
        }
        Grip::Turn => {
            let aside = place - pose.planar().position_in_world();
            if aside.length() > LEAST_ARM_M {
                robot.take(CameraPose { yaw_rad: aside.to_angle(), ..pose });
            }
        }
        Grip::Draw => robot.draw_to(place),
        Grip::MoveThing(thing, offset) => things.obey(Gesture::MoveTo(thing, place + offset)),
        Grip::TurnThing(thing) => {
            let middle = things.shown().iter().find(|placed| placed.thing == thing);
            let aside = middle.map(|placed| place - placed.place.position_in_world());
            if let Some(aside) = aside.filter(|aside| aside.length() > LEAST_ARM_M) {
                things.obey(Gesture::TurnTo(thing, aside.to_angle()));
            }
        }
    }
}

/// Returns the visible part of the field.
fn region(canvas: &FieldCanvas) -> Region {
    let (a, b) = (canvas.in_world(canvas.rect.min), canvas.in_world(canvas.rect.max));
    [a.min(b), a.max(b)]
}

/// States how many edges are drawn, if not all are.
fn edges_ui(ui: &mut Ui, is_on: bool, around: Option<&Around>) {
    let Some(around) = around.filter(|_| is_on) else { return };
    let shown: usize = around.edges.iter().map(|sector| sector.shown_in_world.len()).sum();
    let count: usize = around.edges.iter().map(|sector| sector.count).sum();
    if shown < count {
        ui.weak(format!("triangulation: {shown} of {count} edges shown"));
    }
}

#[cfg(test)]
mod tests;
