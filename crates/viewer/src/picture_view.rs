//! Camera pictures on the screen: uploaded once, drawn as large as fits, with conversion between pixels and screen
//! positions.

use std::sync::Arc;

use eframe::egui::{
    Align2, Color32, ColorImage, Context, CursorIcon, FontId, Painter, Pos2, Rect, Response, Role, Sense,
    Stroke, TextureHandle, TextureId, TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use glam::DVec2;
use image::{GrayImage, RgbImage};

/// Converts a picture for the screen. Call it in the thread that has the picture: converting takes a millisecond.
pub fn color_image(picture: &RgbImage) -> Arc<ColorImage> {
    let size = [picture.width() as usize, picture.height() as usize];
    Arc::new(ColorImage::from_rgb(size, picture.as_raw()))
}

/// Converts a grey picture for the screen.
pub fn gray_image(picture: &GrayImage) -> Arc<ColorImage> {
    let size = [picture.width() as usize, picture.height() as usize];
    Arc::new(ColorImage::from_gray(size, picture.as_raw()))
}

/// Picture on the graphics device.
#[derive(Default)]
pub struct Uploaded {
    texture: Option<TextureHandle>,
    picture: Option<Arc<ColorImage>>,
}

impl Uploaded {
    /// Returns the texture of a picture, uploading it if it differs from the last one.
    pub fn texture(&mut self, ctx: &Context, picture: &Arc<ColorImage>) -> TextureId {
        let texture = self.texture.get_or_insert_with(|| {
            ctx.load_texture("camera picture", ColorImage::default(), TextureOptions::LINEAR)
        });
        if !self.picture.as_ref().is_some_and(|uploaded| Arc::ptr_eq(uploaded, picture)) {
            texture.set(picture.clone(), TextureOptions::LINEAR);
            self.picture = Some(picture.clone());
        }
        texture.id()
    }

    /// Returns the picture uploaded last.
    pub fn picture(&self) -> Option<&Arc<ColorImage>> {
        self.picture.as_ref()
    }
}

/// A picture as drawn in one frame.
pub struct PictureCanvas {
    pub painter: Painter,
    pub rect: Rect,
    pub response: Response,
    /// Points on the screen per pixel.
    scale: f32,
}

const WHOLE: Rect = Rect { min: Pos2::ZERO, max: pos2(1.0, 1.0) };

impl PictureCanvas {
    /// Allocates space for a picture of `pixels`, as large as fits into `room`, black until something is drawn.
    pub fn allocate(ui: &mut Ui, pixels: [usize; 2], room: Vec2, name: &str) -> Self {
        let pixels = vec2(pixels[0].max(1) as f32, pixels[1].max(1) as f32);
        let scale = (room / pixels).min_elem().max(0.01);
        let (rect, response) = ui.allocate_exact_size(scale * pixels, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, Color32::BLACK);
        Self { painter, rect, response, scale }
    }

    /// Fills the space with a texture.
    pub fn draw(&self, texture: TextureId, tint: Color32) {
        self.painter.image(texture, self.rect, WHOLE, tint);
    }

    /// Lets the user drag the line of a wipe: `share` is 0 at the left edge, 1 at the right one.
    pub fn drag_wipe(&self, ui: &Ui, share: &mut f32) {
        if let Some(pointer) = self
            .response
            .interact_pointer_pos()
            .filter(|_| self.response.dragged() || self.response.clicked())
        {
            *share = ((pointer.x - self.rect.left()) / self.rect.width()).clamp(0.0, 1.0);
        }
        if self.response.hovered() {
            ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
    }

    /// Draws one texture left of a line, another right of it, with a handle to drag the line by: `share` is 0 at the left
    /// edge, 1 at the right one.
    pub fn draw_wipe(&self, left: TextureId, right: TextureId, share: f32) {
        let x = self.rect.left() + share * self.rect.width();
        let sides = [(left, self.rect.left()..=x, 0.0..=share), (right, x..=self.rect.right(), share..=1.0)];
        for (texture, screen, texels) in sides {
            let rect = Rect::from_x_y_ranges(screen, self.rect.y_range());
            self.painter.image(texture, rect, Rect::from_x_y_ranges(texels, 0.0..=1.0), Color32::WHITE);
        }
        for stroke in [Stroke::new(4.0, Color32::from_black_alpha(160)), Stroke::new(1.5, Color32::WHITE)] {
            self.painter.vline(x, self.rect.y_range(), stroke);
        }
        self.painter.circle(
            pos2(x, self.rect.center().y),
            7.0,
            Color32::WHITE,
            (1.5, Color32::from_black_alpha(160)),
        );
    }

    /// Shows text in the middle, on black.
    pub fn words(&self, text: &str) {
        self.painter.rect_filled(self.rect, 0.0, Color32::from_black_alpha(190));
        let font = FontId::proportional(15.0);
        self.painter.text(self.rect.center(), Align2::CENTER_CENTER, text, font, Color32::from_gray(220));
    }

    /// Returns the screen position of a position in the picture. A pixel's centre has integer coordinates.
    pub fn at(&self, pixel: DVec2) -> Pos2 {
        self.rect.min + self.scale * (vec2(pixel.x as f32, pixel.y as f32) + Vec2::splat(0.5))
    }

    /// Returns the position in the picture of a screen position.
    pub fn pixel_at(&self, position: Pos2) -> DVec2 {
        let offset = (position - self.rect.min) / self.scale - Vec2::splat(0.5);
        DVec2::new(f64::from(offset.x), f64::from(offset.y))
    }

    /// Draws polylines given in pixels, with a dark rim.
    pub fn polylines(&self, polylines: &[Vec<DVec2>], color: Color32) {
        for stroke in [Stroke::new(3.5, Color32::from_black_alpha(90)), Stroke::new(1.6, color)] {
            for polyline in polylines {
                let points = polyline.iter().map(|&pixel| self.at(pixel)).collect();
                self.painter.add(eframe::egui::Shape::line(points, stroke));
            }
        }
    }
}
