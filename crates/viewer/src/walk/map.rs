//! The field from above: particles, paths, the estimated pose and the true one. The particles can be dragged.

use eframe::egui::{Color32, CursorIcon, PointerButton, Stroke, Ui, Vec2};
use glam::DVec2;
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::Sequence,
};

use super::{
    cloud::{self, Inset},
    frame::{FrameView, GatheringStep},
    history::{History, Thinned, odometry_path, true_path},
    settings::Layers,
};
use crate::{
    colors,
    field_view::{FieldCanvas, FieldView},
    footprint::Footprint,
};

/// View of the field, and the pose to which the particles are being dragged.
#[derive(Default)]
pub struct Map {
    view: FieldView,
    dragged: Option<Pose2>,
    footprint: Footprint,
    inset: Inset,
}

impl Map {
    /// Draws the map into the room; returns the pose at which the particles were dropped.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        sequence: &Sequence,
        frame: Option<&FrameView>,
        history: &History,
        layers: &mut Layers,
        room: Vec2,
    ) -> Option<Pose2> {
        if let Some(frame) = frame
            && layers.follow
            && frame.gathering.is_none()
            && self.dragged.is_none()
        {
            self.view.follow(frame.record.pose.planar().position_in_world());
        }
        let canvas = self.view.show(ui, &sequence.field, room, "Field from above");
        let frame = frame?;
        let at = frame.record.index;
        let pans = [PointerButton::Secondary, PointerButton::Middle];
        if pans.iter().any(|button| canvas.response.dragged_by(*button)) {
            // A user who moves the view wants to see another part.
            layers.follow = false;
        }
        // The best of particles all over the field jumps about, and a footprint with it.
        if layers.footprint && frame.gathering.is_none() {
            canvas.footprint(self.footprint.outline(&sequence.setup.camera, frame.record.pose));
        }
        if layers.odometry {
            draw_odometry(&canvas, sequence, history, at);
        }
        if layers.truth {
            draw_path(&canvas, &true_path(sequence, at), colors::TRUTH);
        }
        if layers.path {
            draw_path(&canvas, &history.path(at), colors::POSE);
        }
        if layers.particles {
            cloud::draw(&canvas, frame);
        }
        if let Some(truth) = frame.truth.filter(|_| layers.truth) {
            canvas.arrow(truth.planar(), colors::TRUTH);
        }
        if layers.best_particle && frame.has_pose() {
            canvas.arrow(frame.best_particle.planar(), colors::PARTICLE);
        }
        if frame.has_pose() {
            canvas.arrow(frame.record.pose.planar(), colors::POSE);
        }
        if layers.inset && self.dragged.is_none() {
            self.inset.draw(&canvas, &sequence.field, frame, layers);
        }
        if let Some(step) = frame.gathering {
            explain(&canvas, step);
        }
        canvas.hint("drag: move the particles away · wheel: zoom");
        if frame.has_pose() { self.drag(ui, &canvas, frame.record.pose.planar()) } else { None }
    }

    /// Drags the particles with the primary button, keeping their heading.
    fn drag(&mut self, ui: &Ui, canvas: &FieldCanvas, pose: Pose2) -> Option<Pose2> {
        let response = &canvas.response;
        if response.dragged_by(PointerButton::Primary)
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let place = canvas.in_world(pointer);
            self.dragged = Some(Pose2::new(place.x, place.y, pose.yaw_rad));
        } else if !response.drag_stopped() {
            // A drag may end while this field is not shown.
            self.dragged = None;
        }
        if let Some(dragged) = self.dragged {
            ui.set_cursor_icon(CursorIcon::Grabbing);
            canvas.arrow(dragged, Color32::WHITE);
            let ends = [canvas.at(pose.position_in_world()), canvas.at(dragged.position_in_world())];
            canvas.painter.line_segment(ends, Stroke::new(1.0, Color32::WHITE));
        }
        if response.drag_stopped() { self.dragged.take() } else { None }
    }
}

fn draw_path(canvas: &FieldCanvas, path: &Thinned<DVec2>, color: Color32) {
    canvas.path(&path.points, path.step, Stroke::new(2.0, color.gamma_multiply(0.7)));
}

fn draw_odometry(canvas: &FieldCanvas, sequence: &Sequence, history: &History, at: usize) {
    let start = sequence.frames[0].reference_pose.map(CameraPose::planar).or(sequence.start);
    let Some(known) = start.map(|start| (0, start)).or(history.first()) else { return };
    let path = odometry_path(sequence, known, at);
    canvas.path(&path.points, path.step, Stroke::new(1.5, colors::ODOMETRY));
    if let Some(last) = path.points.last() {
        canvas.painter.circle_filled(canvas.at(*last), 3.5, colors::ODOMETRY);
    }
}

/// Says what the gathering particles do.
fn explain(canvas: &FieldCanvas, step: GatheringStep) {
    if step.is_spread() {
        canvas.title("Nothing is known yet: particles are spread over the field");
    } else {
        canvas.title(&format!("They gather where the picture fits: {} of {}", step.number, step.of));
    }
}
