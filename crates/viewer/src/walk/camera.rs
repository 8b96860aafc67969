//! The camera's picture, and what is drawn over it.

use eframe::egui::{Color32, Ui, Vec2};

use super::{frame::FrameView, settings::Layers};
use crate::{
    colors,
    picture_view::{PictureCanvas, Uploaded},
};

/// The picture and its veil on the graphics device.
#[derive(Default)]
pub struct CameraTextures {
    picture: Uploaded,
    veil: Uploaded,
}

/// Draws picture and layers into the room.
pub fn ui(ui: &mut Ui, frame: &FrameView, layers: &Layers, textures: &mut CameraTextures, room: Vec2) {
    let canvas = PictureCanvas::allocate(ui, frame.picture.size, room, "Camera picture");
    canvas.draw(textures.picture.texture(ui.ctx(), &frame.picture), Color32::WHITE);
    if let Some(veil) = &frame.veil {
        let tint = Color32::WHITE.gamma_multiply(layers.veil_opacity);
        canvas.draw(textures.veil.texture(ui.ctx(), veil), tint);
    }
    let drawn = [
        (layers.border, &frame.border, colors::BORDER),
        (layers.truth, &frame.truth_lines, colors::TRUTH),
        (layers.best_particle, &frame.best_lines, colors::PARTICLE),
        (layers.pose, &frame.pose_lines, colors::POSE),
    ];
    for (_, polylines, color) in drawn.into_iter().filter(|(is_on, ..)| *is_on) {
        canvas.polylines(polylines, color);
    }
}
