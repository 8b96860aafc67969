//! The field from above: the robot to drag, the path to draw, and what is known around it in layers.

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, PointerButton, Pos2, Rect, Shape, Stroke, Ui, Vec2, vec2,
};
use glam::DVec2;
use reality_sim_core::pose::{CameraPose, Pose2};
use reality_sim_db::coverage::{Coverage, CoverageCell, FAR_PX, shade_srgb};
use reality_sim_synthesis::{ORIGIN_HUES, UsedImage};
use serde::{Deserialize, Serialize};

use super::{
    edges::{Edges, Region},
    painter::Around,
    robot::Robot,
    source::{Probes, Source},
};
use crate::{
    background::{Outcome, Task},
    colors,
    field_view::{FieldCanvas, FieldView},
    footprint::Footprint,
    problems::Problems,
};

/// The field is shown with so much around it, metres: the robot may go there.
const MARGIN_M: f64 = 1.0;
/// Side of a cell of the coverage, metres.
const CELL_M: f64 = 0.25;
/// The arrow's ends are caught from this far, points.
const CATCH: f32 = 14.0;
/// More marks than this are not seen one by one: every so many-th is drawn.
const MOST_MARKS: usize = 3000;
/// Weights below this are not written.
const LEAST_WEIGHT: f64 = 0.005;

/// What the layer of the neighbours shows.
const NEIGHBOURS_MEAN: &str = "The natural neighbours with their weights by where pictures were taken (Sibson, 1981). How many pixels a picture gave in the end is another number: it is below the picture, after “made of”.";

/// Recorded pictures' places.
const IMAGES: Color32 = Color32::from_rgb(200, 205, 210);
/// The triangulation.
const EDGES: Color32 = Color32::from_rgb(120, 215, 190);
/// The drawn path.
const PATH: Color32 = Color32::WHITE;

/// What is drawn on the field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layers {
    /// Where pictures were recorded.
    pub images: bool,
    pub coverage: CoverageLayer,
    /// The Delaunay triangulation of the sectors around the heading.
    pub triangulation: bool,
    /// The natural neighbours and their weights.
    pub neighbours: bool,
    /// The images that the picture is made of.
    pub used: bool,
    /// The ground in the picture.
    pub footprint: bool,
    /// True pictures to compare with.
    pub probes: bool,
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            images: true,
            coverage: CoverageLayer::Off,
            triangulation: false,
            neighbours: false,
            used: true,
            footprint: true,
            probes: true,
        }
    }
}

/// What the carpet is coloured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CoverageLayer {
    #[default]
    Off,
    /// How many pictures were taken there.
    Pictures,
    /// How far the nearest picture is.
    Distance,
}

impl CoverageLayer {
    const ALL: [Self; 3] = [Self::Off, Self::Pictures, Self::Distance];

    fn name(self) -> &'static str {
        match self {
            Self::Off => "no coverage",
            Self::Pictures => "pictures taken there",
            Self::Distance => "pixels to the nearest picture",
        }
    }
}

/// What was caught with the mouse.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Grip {
    /// The arrow's tail, this far from where it was caught, metres.
    Move(DVec2),
    /// The arrow's tip.
    Turn,
    /// The path.
    Draw,
}

/// The coverage, counted once.
enum Counted {
    NotYet,
    Counting(Task<Coverage>),
    Done(Coverage),
    /// Not possible, or not wanted.
    Never,
}

/// The field from above.
pub struct Map {
    view: FieldView,
    grip: Option<Grip>,
    is_drawing: bool,
    coverage: Counted,
    footprint: Footprint,
    seen: Region,
}

/// What there is to draw.
pub struct Scene<'a> {
    pub source: &'a Arc<Source>,
    pub layers: Layers,
    pub around: Option<&'a Around>,
    /// The images that a picture is made of.
    pub used: &'a [UsedImage],
    /// Which picture.
    pub used_by: &'static str,
    pub probes: Option<&'a Probes>,
}

impl Default for Map {
    fn default() -> Self {
        Self {
            view: FieldView::with_margin(MARGIN_M),
            grip: None,
            is_drawing: false,
            coverage: Counted::NotYet,
            footprint: Footprint::default(),
            seen: [DVec2::ZERO; 2],
        }
    }
}

/// Counting holds the database, which may be a temporary one: it is waited for.
impl Drop for Map {
    fn drop(&mut self) {
        if let Counted::Counting(task) = std::mem::replace(&mut self.coverage, Counted::Never) {
            task.finish();
        }
    }
}

impl Map {
    /// Shows the field as large as fits into some room, and lets the robot be dragged.
    pub fn ui(&mut self, ui: &mut Ui, room: Vec2, scene: &Scene, robot: &mut Robot) {
        let field = scene.source.archive.field();
        let extent = 2.0 * (field.carpet_half_extent_m() + MARGIN_M);
        let height = (room.x * (extent.y / extent.x) as f32).min(room.y).max(80.0);
        let canvas = self.view.show(ui, field, vec2(room.x, height), "the field from above");
        self.drag(ui, &canvas, robot);
        self.seen = region(&canvas);
        self.draw_coverage(&canvas, scene);
        if scene.layers.footprint {
            canvas.footprint(self.footprint.outline(&scene.source.archive.setup().camera, robot.pose()));
        }
        draw_known(&canvas, scene, robot.pose());
        draw_path(&canvas, robot.path());
        canvas.arrow(robot.pose().planar(), colors::POSE);
        write_pointer(&canvas);
    }

    /// The part of the field that was shown last.
    pub fn seen(&self) -> Region {
        self.seen
    }

    /// Follows the path, or stops; what is dragged then is the robot.
    pub fn follow_or_stop(&mut self, robot: &mut Robot) {
        self.is_drawing = false;
        robot.follow_or_stop();
    }

    /// Drawing, following and forgetting a path.
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

    /// The layers to switch, each with its colour.
    pub fn layers_ui(&mut self, ui: &mut Ui, scene: &Scene, layers: &mut Layers) {
        let used_mean = format!(
            "The images that the picture “{}” is made of, in the colours of its origins",
            scene.used_by
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
            ui.weak(format!("in use: by the picture “{}”", scene.used_by));
        }
        if layers.neighbours {
            ui.weak("neighbours: with their natural neighbour weights, not shares of pixels")
                .on_hover_text(NEIGHBOURS_MEAN);
        }
        edges_ui(ui, layers.triangulation, scene.around);
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
            self.coverage_legend(ui, scene, layers.coverage);
        });
    }

    /// Counts the coverage once it is wanted.
    pub fn poll(&mut self, ui: &Ui, source: &Arc<Source>, layers: &mut Layers, problems: &mut Problems) {
        if layers.coverage == CoverageLayer::Off {
            return;
        }
        match &self.coverage {
            Counted::NotYet => {
                let source = source.clone();
                self.coverage =
                    Counted::Counting(Task::spawn(ui.ctx(), "Looking at the coverage …", move |progress| {
                        let (archive, goes_on) = (&source.archive, || !progress.is_cancelled());
                        let (field, usual) = (archive.field(), archive.usual_pose());
                        let coverage = Coverage::new_while(archive.index(), field, usual, CELL_M, goes_on);
                        coverage.ok_or_else(|| "cancelled".to_owned())
                    }));
            }
            Counted::Counting(task) => match task.poll() {
                Some(Outcome::Done(coverage)) => self.coverage = Counted::Done(coverage),
                Some(Outcome::Failed(reason)) => {
                    problems.add(reason);
                    self.coverage = Counted::Never;
                }
                Some(Outcome::Cancelled) => {
                    (self.coverage, layers.coverage) = (Counted::NotYet, CoverageLayer::Off);
                }
                None => {}
            },
            Counted::Done(_) | Counted::Never => {}
        }
    }

    fn coverage_legend(&self, ui: &mut Ui, scene: &Scene, layer: CoverageLayer) {
        match (&self.coverage, layer) {
            (_, CoverageLayer::Off) | (Counted::NotYet | Counted::Never, _) => {}
            (Counted::Counting(task), _) => task.ui(ui),
            (Counted::Done(coverage), CoverageLayer::Pictures) => {
                ui.weak("1");
                scale(ui, |share| shade(share.max(1.0 / most(coverage))));
                let square = 100.0 * coverage.cell_m;
                ui.weak(format!("{:.0} in {square:.0} cm × {square:.0} cm", most(coverage)));
            }
            (Counted::Done(_), CoverageLayer::Distance) => {
                ui.weak("0");
                scale(ui, |share| shade(1.0 - share));
                ui.weak(format!("{FAR_PX:.0} px or more, mean over all headings"));
            }
        }
        if scene.source.archive.images().len() > MOST_MARKS && scene.layers.images {
            ui.weak("Not every recorded picture is drawn.");
        }
    }

    fn drag(&mut self, ui: &Ui, canvas: &FieldCanvas, robot: &mut Robot) {
        let pose = robot.pose();
        let caught = |at: Pos2| self.caught(canvas, pose.planar(), at);
        if let Some(grip) = canvas.response.hover_pos().and_then(caught) {
            ui.set_cursor_icon(match grip {
                Grip::Draw => CursorIcon::Crosshair,
                Grip::Move(_) => CursorIcon::Grab,
                Grip::Turn => CursorIcon::Alias,
            });
        }
        if canvas.response.drag_started_by(PointerButton::Primary) {
            self.grip = ui.input(|input| input.pointer.press_origin()).and_then(caught);
            if self.grip == Some(Grip::Draw) {
                robot.clear_path();
            }
        }
        let pointer = canvas.response.interact_pointer_pos();
        if let (Some(grip), Some(at), true) =
            (self.grip, pointer, canvas.response.dragged_by(PointerButton::Primary))
        {
            let place = canvas.in_world(at);
            match grip {
                Grip::Move(offset) => {
                    let place = place + offset;
                    robot.take(pose.with_planar(Pose2::new(place.x, place.y, pose.yaw_rad)));
                }
                Grip::Turn => {
                    let aside = place - pose.planar().position_in_world();
                    if aside.length() > 1e-3 {
                        robot.take(CameraPose { yaw_rad: aside.to_angle(), ..pose });
                    }
                }
                Grip::Draw => robot.draw_to(place),
            }
        }
        // A drag may also end where the field is not shown.
        if !canvas.response.dragged() {
            self.grip = None;
        }
    }

    /// What there is to catch at a place.
    fn caught(&self, canvas: &FieldCanvas, planar: Pose2, at: Pos2) -> Option<Grip> {
        if self.is_drawing {
            return Some(Grip::Draw);
        }
        let tail = planar.position_in_world();
        let (to_tail, to_tip) = (canvas.at(tail).distance(at), canvas.arrow_tip(planar).distance(at));
        match () {
            () if to_tail.min(to_tip) > CATCH => None,
            () if to_tail <= to_tip => Some(Grip::Move(tail - canvas.in_world(at))),
            () => Some(Grip::Turn),
        }
    }

    fn draw_coverage(&self, canvas: &FieldCanvas, scene: &Scene) {
        let Counted::Done(coverage) = &self.coverage else { return };
        let most = most(coverage);
        let color = |cell: &CoverageCell| match scene.layers.coverage {
            CoverageLayer::Off => None,
            CoverageLayer::Pictures if cell.count() == 0 => None,
            CoverageLayer::Pictures => Some(shade(f64::from(cell.count()) / most)),
            CoverageLayer::Distance => Some(shade(1.0 - cell.mean_distance_px() / FAR_PX)),
        };
        let half = DVec2::splat(0.5 * coverage.cell_m);
        for cell in &coverage.cells {
            if let Some(color) = color(cell) {
                let corners = [cell.middle_in_world - half, cell.middle_in_world + half]
                    .map(|corner| canvas.at(corner));
                let rect = Rect::from_two_pos(corners[0], corners[1]);
                canvas.painter.rect_filled(rect, 0.0, color.gamma_multiply(0.8));
            }
        }
    }
}

/// The colour of a share of the coverage: on the dark carpet the better covered is the brighter.
fn shade(share: f64) -> Color32 {
    let [red, green, blue] = shade_srgb(1.0 - share);
    Color32::from_rgb(red, green, blue)
}

fn most(coverage: &Coverage) -> f64 {
    f64::from(coverage.cells.iter().map(CoverageCell::count).max().unwrap_or(0).max(1))
}

/// The colour of the image that is so many-th in use.
pub fn hue(number: usize) -> Color32 {
    let [red, green, blue] = ORIGIN_HUES[number % ORIGIN_HUES.len()];
    Color32::from_rgb(red, green, blue)
}

/// A small square of a colour, in a text.
pub fn swatch(color: Color32) -> egui::Atom<'static> {
    egui::Atom::paint(Vec2::splat(10.0), move |ui, args| {
        let stroke = Stroke::new(1.0, Color32::from_gray(110));
        ui.painter().rect(args.rect, 2.0, color, stroke, egui::StrokeKind::Inside);
    })
}

/// A strip of colours.
fn scale(ui: &mut Ui, color: impl Fn(f64) -> Color32) {
    const STEPS: u32 = 24;
    let (rect, _) = ui.allocate_exact_size(vec2(96.0, 10.0), egui::Sense::hover());
    let step = rect.width() / STEPS as f32;
    for number in 0..STEPS {
        let color = color(f64::from(number) / f64::from(STEPS - 1));
        let left = rect.left() + step * number as f32;
        let part = Rect::from_x_y_ranges(left..=left + step, rect.y_range());
        ui.painter().rect_filled(part, 0.0, color);
    }
}

fn draw_known(canvas: &FieldCanvas, scene: &Scene, pose: CameraPose) {
    let Scene { source, layers, around, used, probes, used_by: _ } = scene;
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

/// A dot and where it looks.
fn mark(canvas: &FieldCanvas, planar: Pose2, radius: f32, color: Color32) {
    let at = canvas.at(planar.position_in_world());
    let direction = vec2(planar.yaw_rad.cos() as f32, -planar.yaw_rad.sin() as f32);
    canvas.painter.circle_filled(at, radius, color);
    let end = at + (radius + 5.0) * direction;
    canvas.painter.line_segment([at, end], Stroke::new(0.6 * radius.min(3.0), color));
}

/// A small hollow diamond.
fn draw_probe(canvas: &FieldCanvas, planar: Pose2) {
    let at = canvas.at(planar.position_in_world());
    let corners = [vec2(0.0, -2.5), vec2(2.5, 0.0), vec2(0.0, 2.5), vec2(-2.5, 0.0)];
    let corners = corners.map(|offset| at + offset).to_vec();
    canvas.painter.add(Shape::closed_line(corners, Stroke::new(1.0, colors::TRUTH)));
}

/// The part of the field that is shown.
fn region(canvas: &FieldCanvas) -> Region {
    let (a, b) = (canvas.in_world(canvas.rect.min), canvas.in_world(canvas.rect.max));
    [a.min(b), a.max(b)]
}

fn draw_triangulation(canvas: &FieldCanvas, sectors: &[Edges]) {
    for sector in sectors {
        let color = EDGES.gamma_multiply(0.25 + 0.6 * sector.share as f32);
        for ends in &sector.shown_in_world {
            canvas.painter.line_segment(ends.map(|end| canvas.at(end)), Stroke::new(1.0, color));
        }
    }
}

/// Says where not all edges are drawn.
fn edges_ui(ui: &mut Ui, is_on: bool, around: Option<&Around>) {
    let Some(around) = around.filter(|_| is_on) else { return };
    let shown: usize = around.edges.iter().map(|sector| sector.shown_in_world.len()).sum();
    let count: usize = around.edges.iter().map(|sector| sector.count).sum();
    if shown < count {
        ui.weak(format!("triangulation: {shown} of {count} edges shown"));
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
        // Away from the robot, where the lines are not.
        // Those at the robot's feet one below the other.
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

/// The place under the mouse, in numbers.
fn write_pointer(canvas: &FieldCanvas) {
    if let Some(pointer) = canvas.response.hover_pos() {
        let place = canvas.in_world(pointer);
        let text = format!("x {:.2} m, y {:.2} m", place.x, place.y);
        let corner = canvas.rect.right_bottom() - vec2(10.0, 10.0);
        let font = FontId::proportional(11.0);
        canvas.painter.text(corner, Align2::RIGHT_BOTTOM, text, font, colors::LINE);
    }
}

fn draw_path(canvas: &FieldCanvas, path: &[DVec2]) {
    let points: Vec<Pos2> = path.iter().map(|&place| canvas.at(place)).collect();
    for stroke in [Stroke::new(4.0, Color32::from_black_alpha(140)), Stroke::new(2.0, PATH)] {
        canvas.painter.add(Shape::line(points.clone(), stroke));
    }
    if let [.., last] = &points[..] {
        canvas.painter.circle(*last, 4.0, PATH, Stroke::new(1.0, Color32::BLACK));
    }
}

#[cfg(test)]
mod tests;
