//! The camera's picture and its overlays.

use eframe::egui::{Color32, Ui};

use super::{frame::FrameView, settings::Layers};
use crate::{
    colors,
    picture_view::{PictureCanvas, Uploaded},
};

/// Picture and veil on the graphics device.
#[derive(Default)]
pub struct CameraTextures {
    picture: Uploaded,
    veil: Uploaded,
}

impl CameraTextures {
    /// Draws the picture and its layers.
    pub fn draw(&mut self, ui: &Ui, canvas: &PictureCanvas, frame: &FrameView, layers: &Layers) {
        canvas.draw(self.picture.texture(ui.ctx(), &frame.picture), Color32::WHITE);
        if let Some(veil) = &frame.veil {
            let tint = Color32::WHITE.gamma_multiply(layers.veil_opacity);
            canvas.draw(self.veil.texture(ui.ctx(), veil), tint);
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
}
