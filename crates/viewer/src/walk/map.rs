//! The field from above: particles, paths, the pose found and the true one; particles can be dragged away.

use eframe::egui::{Color32, CursorIcon, PointerButton, Stroke, Ui, Vec2};
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::Sequence,
};

use super::{
    frame::FrameView,
    history::{History, odometry_path, true_path},
    settings::Layers,
};
use crate::{
    colors,
    field_view::{FieldCanvas, FieldView},
    footprint::footprint,
};

/// The view, and the place that the particles are being dragged to.
#[derive(Default)]
pub struct Map {
    view: FieldView,
    dragged: Option<Pose2>,
}

impl Map {
    /// Draws it into the room; gives the place where the particles were dropped.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        sequence: &Sequence,
        frame: &FrameView,
        history: &History,
        layers: &Layers,
        room: Vec2,
    ) -> Option<Pose2> {
        if layers.follow && self.dragged.is_none() {
            self.view.follow(frame.record.pose.planar().position_in_world());
        }
        let canvas = self.view.show(ui, &sequence.field, room, "Field from above");
        let at = frame.record.index;
        if layers.footprint {
            canvas.footprint(&footprint(&sequence.setup.camera, frame.record.pose));
        }
        if layers.odometry {
            draw_odometry(&canvas, sequence, frame, at);
        }
        if layers.truth {
            canvas.path(true_path(sequence, at), Stroke::new(2.0, colors::TRUTH.gamma_multiply(0.7)));
        }
        if layers.path {
            canvas.path(history.path(at), Stroke::new(2.0, colors::POSE.gamma_multiply(0.7)));
        }
        if layers.particles {
            draw_particles(&canvas, frame);
        }
        if let Some(truth) = frame.truth.filter(|_| layers.truth) {
            canvas.arrow(truth.planar(), colors::TRUTH);
        }
        if layers.best_particle {
            canvas.arrow(frame.best_particle.planar(), colors::PARTICLE);
        }
        canvas.arrow(frame.record.pose.planar(), colors::POSE);
        canvas.hint("drag: move the particles away · wheel: zoom");
        self.drag(ui, &canvas, frame.record.pose.planar())
    }

    /// A drag with the primary button takes the particles along, keeping their heading.
    fn drag(&mut self, ui: &Ui, canvas: &FieldCanvas, pose: Pose2) -> Option<Pose2> {
        let response = &canvas.response;
        if response.dragged_by(PointerButton::Primary)
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let place = canvas.in_world(pointer);
            self.dragged = Some(Pose2::new(place.x, place.y, pose.yaw_rad));
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

fn draw_odometry(canvas: &FieldCanvas, sequence: &Sequence, frame: &FrameView, at: usize) {
    let start = sequence.groundtruth[0].map(CameraPose::planar).or(sequence.start);
    let Some(start) = start.or((at == 0).then(|| frame.record.pose.planar())) else { return };
    let path = odometry_path(sequence, start, at);
    canvas.path(path.iter().map(|pose| pose.position_in_world()), Stroke::new(1.5, colors::ODOMETRY));
    if let Some(last) = path.last() {
        canvas.painter.circle_filled(canvas.at(last.position_in_world()), 3.5, colors::ODOMETRY);
    }
}

/// The heavier a particle, the brighter and larger.
fn draw_particles(canvas: &FieldCanvas, frame: &FrameView) {
    for particle in &frame.particles {
        let shown = particle.relative_weight.sqrt();
        let color = colors::PARTICLE.gamma_multiply(0.25 + 0.75 * shown);
        canvas.painter.circle_filled(canvas.at(particle.pose.position_in_world()), 1.2 + 1.6 * shown, color);
    }
}
