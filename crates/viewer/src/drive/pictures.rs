//! The pictures at the robot's pose: one, two side by side, two with a line between them, or all methods.

use std::{collections::BTreeMap, sync::Arc};

use eframe::egui::{
    self, Align, Button, Color32, ColorImage, ComboBox, Layout as Flow, Rect, RichText, TextureId, Ui,
    UiBuilder, Vec2, emath::GuiRounding as _, vec2,
};
use reality_sim_core::pose::CameraPose;
use reality_sim_synthesis::Archive;

use super::{
    answer::{Drawn, Facts, Painted},
    hand::{Hand, Touched},
    kind::{Aspect, Pane, PictureKind},
    layout::Layout,
    legend,
    settings::DriveSettings,
    source::NearProbe,
    things::{Gesture, Things},
};
use crate::{
    picture_view::{PictureCanvas, Uploaded},
    shortcuts::{self, Action},
};

/// Height of the text line above a picture, points.
const HEAD: f32 = 22.0;
/// Least width, points, at which the line has room for both numbers and the mark of an outdated picture.
const ROOM_FOR_FACTS: f32 = 200.0;
/// Explanation of the numbers above a picture.
const FACTS_MEAN: &str = "px away: by how many pixels the picture moves from there to here, root mean square\nPSNR: likeness to the true picture at this very pose, over the carpet; higher is better\nrecorded: the share of the pixels that recorded pictures show; the others are filled in\nms: the time that it took";

/// Data to show.
pub struct Gallery<'a> {
    pub archive: &'a Archive,
    pub painted: &'a BTreeMap<Pane, Painted>,
    pub probe: Option<NearProbe>,
    /// Pose of the robot and the things: pictures may still belong to earlier ones.
    pub pose: CameraPose,
    pub things: &'a Things,
}

/// What the user asks for in the pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Asked {
    /// Goes to another pose.
    Pose(CameraPose),
    /// Changes a thing.
    Change(Gesture),
}

/// Pictures on the screen.
#[derive(Default)]
pub struct Pictures {
    uploaded: BTreeMap<Pane, Uploaded>,
    black: Uploaded,
    hand: Hand,
}

impl Pictures {
    /// Shows the choice of pictures and their arrangement.
    pub fn choice_ui(ui: &mut Ui, settings: &mut DriveSettings, has_clean_stage: bool) {
        ui.horizontal_wrapped(|ui| {
            for (layout, name, meaning) in Layout::ALL {
                ui.selectable_value(&mut settings.layout, layout, name).on_hover_text(meaning);
            }
            ui.separator();
            match settings.layout {
                Layout::All => {}
                Layout::One => kind_box(ui, "Picture", &mut settings.left),
                Layout::Side | Layout::Wipe => {
                    kind_box(ui, "Left", &mut settings.left);
                    if ui.button("Swap").on_hover_text("Swap left and right").clicked() {
                        std::mem::swap(&mut settings.left, &mut settings.right);
                    }
                    kind_box(ui, "Right", &mut settings.right);
                }
            }
        });
        ui.horizontal_wrapped(|ui| {
            if settings.layout != Layout::All {
                aspect_box(ui, settings);
            }
            ui.checkbox(&mut settings.is_best_effort, "Best effort").on_hover_text(
                "A picture also where little was recorded: what no recorded picture shows is filled in smoothly",
            );
            clean_box(ui, settings, has_clean_stage);
            let key = shortcuts::name(ui, Action::Labels);
            ui.checkbox(&mut settings.is_labelled, "Labels").on_hover_text(format!(
                "Draw what is known of every pixel over the pictures: classes, things, lines and crossings ({key})"
            ));
        });
    }

    /// Shows the pictures; returns what the user asks for in them.
    pub fn ui(&mut self, ui: &mut Ui, settings: &mut DriveSettings, gallery: &Gallery) -> Option<Asked> {
        let panes = settings.panes();
        self.hand.rest(ui);
        let legend = legend::height(settings);
        let room = (ui.available_size() - vec2(0.0, legend)).max(Vec2::splat(60.0));
        let asked = match (settings.layout, &panes[..]) {
            (Layout::Wipe, &[left, right]) => {
                self.wipe(ui, [left, right], room, &mut settings.wipe_share, gallery)
            }
            _ => self.grid(ui, &panes, room, gallery),
        };
        let drawn = gallery.painted.get(&panes[0]).and_then(|painted| painted.result.as_ref().ok());
        legend::ui(ui, settings, drawn, gallery.archive);
        asked
    }

    /// Shows all panes, in the number of columns that makes them largest.
    fn grid(&mut self, ui: &mut Ui, panes: &[Pane], room: Vec2, gallery: &Gallery) -> Option<Asked> {
        let gap = ui.spacing().item_spacing;
        let pixels = size_of(gallery.archive);
        let cell = |columns: usize| {
            let rows = panes.len().div_ceil(columns);
            let [columns, rows] = [columns as f32, rows as f32];
            vec2((room.x - gap.x * columns) / columns, (room.y - gap.y * rows) / rows - HEAD - gap.y)
        };
        let scale = |columns: usize| (cell(columns) / vec2(pixels[0] as f32, pixels[1] as f32)).min_elem();
        let largest = (1..=panes.len()).max_by(|&a, &b| scale(a).total_cmp(&scale(b))).unwrap_or(1);
        // Two pictures are easier to compare side by side.
        let columns = if panes.len() == 2 && scale(2) > 0.7 * scale(1) { 2 } else { largest };
        let mut asked = None;
        for row in panes.chunks(columns) {
            ui.horizontal_top(|ui| {
                for &pane in row {
                    ui.vertical(|ui| asked = self.pane(ui, pane, cell(columns), gallery).or(asked));
                }
            });
        }
        asked
    }

    /// Shows one picture under its name, or the reason why there is none.
    fn pane(&mut self, ui: &mut Ui, pane: Pane, room: Vec2, gallery: &Gallery) -> Option<Asked> {
        let painted = gallery.painted.get(&pane);
        let pixels = size_of(gallery.archive);
        let width = (room / vec2(pixels[0] as f32, pixels[1] as f32)).min_elem() * pixels[0] as f32;
        ui.set_width(width.max(40.0));
        head(ui, pane, painted, gallery);
        let canvas = PictureCanvas::allocate(ui, pixels, room, &described(pane, painted));
        match painted.map(|painted| (painted.pose, &painted.result)) {
            Some((pose, Ok(drawn))) => {
                let texture = self.texture(ui, pane, &drawn.picture);
                canvas.draw(texture, Color32::WHITE);
                draw_marks(drawn, &canvas, canvas.rect);
                self.hand.touch(ui, &canvas, &touched(pane, pose, drawn, gallery)).map(Asked::Change)
            }
            Some((_, Err(reason))) => words(ui, canvas.rect, pane, reason, gallery.probe),
            None => waiting(ui, canvas.rect),
        }
    }

    /// Shows two pictures with a line between them.
    fn wipe(
        &mut self,
        ui: &mut Ui,
        panes: [Pane; 2],
        room: Vec2,
        share: &mut f32,
        gallery: &Gallery,
    ) -> Option<Asked> {
        let painted = panes.map(|pane| gallery.painted.get(&pane));
        let pixels = size_of(gallery.archive);
        let room = room - vec2(0.0, 2.0 * (HEAD + ui.spacing().item_spacing.y));
        for (side, (pane, painted)) in
            ["left of the line:", "right of it:"].iter().zip(panes.iter().zip(painted))
        {
            ui.horizontal(|ui| {
                ui.weak(*side);
                head(ui, *pane, painted, gallery);
            });
        }
        let names = [0, 1].map(|side| described(panes[side], painted[side]));
        let name = format!("{}, {:.0} % of the width; then {}", names[0], 100.0 * *share, names[1]);
        let canvas = PictureCanvas::allocate(ui, pixels, room.max(Vec2::splat(40.0)), &name);
        let textures = [0, 1].map(|side| match painted[side].map(|painted| &painted.result) {
            Some(Ok(drawn)) => self.texture(ui, panes[side], &drawn.picture),
            _ => self.no_picture(ui),
        });
        let line = |share: f32| canvas.rect.left() + share * canvas.rect.width();
        let side = self.side(&canvas, panes, line(*share));
        let mut asked = None;
        if let Some(Painted { pose, result: Ok(drawn), .. }) = painted[side] {
            let touched = touched(panes[side], *pose, drawn, gallery);
            asked = self.hand.touch(ui, &canvas, &touched).map(Asked::Change);
        }
        if !self.hand.is_holding() && asked.is_none() {
            canvas.drag_wipe(ui, share);
        }
        canvas.draw_wipe(textures[0], textures[1], *share);
        let line = line(*share);
        let halves = [canvas.rect.with_max_x(line), canvas.rect.with_min_x(line)];
        for side in [0, 1] {
            if let Some(Ok(drawn)) = painted[side].map(|painted| &painted.result) {
                draw_marks(drawn, &canvas, halves[side]);
            }
            if let Some(Err(reason)) = painted[side].map(|painted| &painted.result)
                && halves[side].width() > 100.0
            {
                asked = words(ui, halves[side], panes[side], reason, gallery.probe).or(asked);
            }
        }
        asked
    }

    /// Returns which of the two pictures of a wipe the mouse touches: the one that the hand began with, or the one under the
    /// pointer.
    fn side(&self, canvas: &PictureCanvas, panes: [Pane; 2], line: f32) -> usize {
        let held = self.hand.pane().and_then(|held| panes.iter().position(|pane| *pane == held));
        let pointer = canvas.response.interact_pointer_pos().or(canvas.response.hover_pos());
        held.unwrap_or_else(|| usize::from(pointer.is_some_and(|pointer| pointer.x > line)))
    }

    fn texture(&mut self, ui: &Ui, pane: Pane, picture: &Arc<ColorImage>) -> TextureId {
        self.uploaded.entry(pane).or_default().texture(ui.ctx(), picture)
    }

    fn no_picture(&mut self, ui: &Ui) -> TextureId {
        let black = self.black.picture().cloned();
        let black = black.unwrap_or_else(|| Arc::new(ColorImage::filled([1, 1], Color32::BLACK)));
        self.black.texture(ui.ctx(), &black)
    }
}

fn size_of(archive: &Archive) -> [usize; 2] {
    let camera = &archive.setup().camera;
    [camera.width as usize, camera.height as usize]
}

fn kind_box(ui: &mut Ui, name: &str, kind: &mut PictureKind) {
    let label = ui.label(name);
    let chosen = ComboBox::from_id_salt(name).width(110.0).selected_text(kind.name()).show_ui(ui, |ui| {
        for other in PictureKind::ALL {
            ui.selectable_value(kind, other, other.name()).on_hover_text(other.meaning());
        }
    });
    chosen.response.labelled_by(label.id).on_hover_text(kind.meaning());
}

fn aspect_box(ui: &mut Ui, settings: &mut DriveSettings) {
    let words = |aspect: Aspect| match aspect {
        Aspect::Picture => "the picture",
        Aspect::Origins => "where each pixel came from",
        Aspect::Trust => "how far to trust each pixel",
    };
    let name = if settings.layout == Layout::One { "Show" } else { "Show on the left" };
    let label = ui.add(egui::Label::new(name).extend());
    let chosen = ComboBox::from_id_salt("shown").width(180.0).selected_text(words(settings.aspect));
    let chosen = chosen.show_ui(ui, |ui| {
        for aspect in [Aspect::Picture, Aspect::Origins, Aspect::Trust] {
            ui.selectable_value(&mut settings.aspect, aspect, words(aspect));
        }
    });
    chosen.response.labelled_by(label.id);
}

/// Shows the switch of the clean stage.
fn clean_box(ui: &mut Ui, settings: &mut DriveSettings, has_clean_stage: bool) {
    let mut is_on = settings.is_clean && has_clean_stage;
    let clicked = ui
        .add_enabled(has_clean_stage, egui::Checkbox::new(&mut is_on, "Clean stage"))
        .on_hover_text("Without the people, robots and balls that stood there while recording")
        .on_disabled_hover_text("This database does not know what stood there while recording");
    if clicked.changed() {
        settings.is_clean = is_on;
    }
}

/// Returns a picture with the things that the mouse may touch in it.
fn touched<'a>(pane: Pane, pose: CameraPose, drawn: &'a Drawn, gallery: &'a Gallery) -> Touched<'a> {
    let camera = &gallery.archive.setup().camera;
    Touched { pane, camera, pose, seen: &drawn.things, things: gallery.things }
}

/// Draws a picture's labels in the part of it that is shown, if there are any.
fn draw_marks(drawn: &Drawn, canvas: &PictureCanvas, shown: Rect) {
    if let Some(marks) = &drawn.marks {
        marks.draw(canvas, shown);
    }
}

/// Shows a picture's name and facts, and whether it belongs to another pose or other things than there are now.
fn head(ui: &mut Ui, pane: Pane, painted: Option<&Painted>, gallery: &Gallery) {
    let is_old = painted
        .is_some_and(|painted| painted.pose != gallery.pose || painted.things != gallery.things.shown());
    let has_room = !is_old || ui.available_width() > ROOM_FOR_FACTS;
    let drawn = painted.and_then(|painted| painted.result.as_ref().ok());
    let facts = drawn.map(|drawn| &drawn.facts).filter(|_| has_room);
    let names = |ui: &mut Ui| {
        ui.add(egui::Label::new(RichText::new(pane.kind.name()).strong()).truncate())
            .on_hover_text(pane.kind.meaning());
        if let Some(facts) = facts {
            let text = facts_in_words(pane.kind, facts);
            ui.add(egui::Label::new(RichText::new(&text).weak()).truncate())
                .on_hover_text(format!("{text}\n{FACTS_MEAN}"));
        }
    };
    ui.allocate_ui_with_layout(vec2(ui.available_width(), HEAD), Flow::right_to_left(Align::Center), |ui| {
        if is_old {
            ui.weak("updating …").on_hover_text("This is the picture before the last change");
        }
        ui.with_layout(Flow::left_to_right(Align::Center), names);
    });
}

fn facts_in_words(kind: PictureKind, facts: &Facts) -> String {
    let mut words = Vec::new();
    if kind == PictureKind::Auto {
        words.push(format!("by {}", facts.method));
    }
    if let [only] = &facts.used[..] {
        words.push(format!("{:.0} px away", only.distance_px));
    }
    if let Some(probe) = facts.probe {
        words.push(format!("frame {}, {:.0} px away", probe.frame, probe.distance_px));
    }
    if let Some(db) = facts.likeness_db {
        words.push(format!("PSNR {db:.1} dB"));
    }
    if let Some(covered) = facts.covered {
        words.push(format!("{:.0} % recorded", 100.0 * covered));
    }
    words.push(format!("{:.0} ms", facts.times.whole_ms()));
    words.join(" · ")
}

/// Describes a picture in words, for screen readers.
fn described(pane: Pane, painted: Option<&Painted>) -> String {
    let name = pane.kind.name();
    let shown = match pane.aspect {
        Aspect::Picture => "",
        Aspect::Origins => ", where each pixel came from,",
        Aspect::Trust => ", how far to trust it,",
    };
    match painted {
        Some(Painted { pose, result: Ok(drawn), .. }) => {
            let degrees = pose.yaw_rad.to_degrees();
            let marks =
                drawn.marks.as_ref().map_or_else(String::new, |marks| format!(", {}", marks.in_words()));
            format!("{name}{shown} at x {:.2} m, y {:.2} m, yaw {degrees:.0}°{marks}", pose.x_m, pose.y_m)
        }
        Some(_) => format!("no picture: {name}"),
        None => format!("{name} on its way"),
    }
}

fn waiting(ui: &mut Ui, rect: Rect) -> Option<Asked> {
    let place = Rect::from_center_size(rect.center(), Vec2::splat(24.0));
    ui.put(place, egui::Spinner::new().size(24.0));
    None
}

/// Shows why there is no picture, and a button that leads to one.
fn words(ui: &mut Ui, rect: Rect, pane: Pane, reason: &str, probe: Option<NearProbe>) -> Option<Asked> {
    let inside = rect.shrink(0.06 * rect.width()).round_ui();
    let mut child = ui.new_child(
        UiBuilder::new().max_rect(inside).layout(Flow::top_down(Align::Center)).id_salt(pane.kind.name()),
    );
    child.set_clip_rect(rect.intersect(ui.clip_rect()));
    // In a small picture every line counts; what does not fit can be scrolled to.
    let is_small = inside.height() < 140.0;
    child.add_space(if is_small { 0.0 } else { 0.28 * inside.height() });
    let probe = probe.filter(|_| pane.kind == PictureKind::Truth);
    egui::ScrollArea::vertical()
        .show(&mut child, |ui| {
            let text = RichText::new(reason).color(Color32::from_gray(205));
            let text = if is_small { text.small() } else { text };
            // The button comes before the reason if there is no room for both.
            let go = |ui: &mut Ui| probe.filter(|_| ui.add(Button::new("Go there")).clicked());
            let before = if is_small { go(ui) } else { None };
            ui.add(egui::Label::new(text).wrap());
            let after = if is_small { None } else { go(ui) };
            before.or(after).map(|probe| Asked::Pose(probe.pose))
        })
        .inner
}
