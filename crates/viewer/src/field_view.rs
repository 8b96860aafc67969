//! Interactive view of the field from above: +x to the right, +y up, in metres. The wheel zooms, the secondary button moves
//! the view, and a double click on the carpet resets it.

use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Painter, PointerButton, Pos2, Rect, Response, Role, Sense, Shape,
    Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use glam::DVec2;
use reality_sim_core::{
    field::{Curve, FieldDimensions},
    pose::Pose2,
};

use crate::colors;

/// Longest step of a path that is drawn, metres: after a longer one the robot was carried, or the filter jumped.
const MAX_PATH_STEP_M: f64 = 0.5;
/// Least width, points, of views with room for a hint beside the scale.
const ROOM_FOR_HINT: f32 = 430.0;
/// Largest zoom factor.
const MAX_ZOOM: f32 = 40.0;

/// State of the view: the visible part of the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldView {
    zoom: f32,
    middle_in_world: DVec2,
    /// Margin shown around the carpet, metres.
    margin_m: f64,
}

impl Default for FieldView {
    fn default() -> Self {
        Self { zoom: 1.0, middle_in_world: DVec2::ZERO, margin_m: 0.0 }
    }
}

impl FieldView {
    /// Shows the whole carpet with this margin around it, metres.
    pub fn with_margin(margin_m: f64) -> Self {
        Self { margin_m, ..Self::default() }
    }

    /// Draws carpet and lines into a rectangle of this size.
    pub fn show(&mut self, ui: &mut Ui, field: &FieldDimensions, size: Vec2, name: &str) -> FieldCanvas {
        let canvas = self.show_carpet(ui, field.carpet_half_extent_m(), size, name);
        canvas.draw_lines(field, colors::LINE);
        canvas.draw_goals(field);
        canvas.draw_scale();
        canvas
    }

    /// Draws a carpet of this half extent, metres, into a rectangle of this size.
    pub fn show_carpet(&mut self, ui: &mut Ui, half_extent_m: DVec2, size: Vec2, name: &str) -> FieldCanvas {
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
        let room = 2.0 * (half_extent_m + self.margin_m);
        let whole = (size.x / room.x as f32).min(size.y / room.y as f32);
        self.look_around(ui, &response, rect, whole);
        let canvas = FieldCanvas {
            painter: ui.painter_at(rect),
            rect,
            px_per_m: whole * self.zoom,
            middle_in_world: self.middle_in_world,
            response,
        };
        canvas.draw_carpet(half_extent_m);
        canvas
    }

    /// Centres an enlarged view on a position.
    pub fn follow(&mut self, place_in_world: DVec2) {
        if self.zoom > 1.0 {
            self.middle_in_world = place_in_world;
        }
    }

    fn look_around(&mut self, ui: &Ui, response: &Response, rect: Rect, whole: f32) {
        let to_world = |offset: Vec2, zoom: f32| {
            DVec2::new(f64::from(offset.x), f64::from(-offset.y)) / f64::from(whole * zoom)
        };
        if let Some(pointer) = response.hover_pos() {
            let factor = ui.input(|input| input.zoom_delta() * (input.smooth_scroll_delta().y / 200.0).exp());
            let zoom = (self.zoom * factor).clamp(1.0, MAX_ZOOM);
            // The position under the pointer stays there.
            let offset = pointer - rect.center();
            self.middle_in_world += to_world(offset, self.zoom) - to_world(offset, zoom);
            self.zoom = zoom;
        }
        if response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle) {
            self.middle_in_world -= to_world(response.drag_delta(), self.zoom);
            ui.set_cursor_icon(CursorIcon::Grabbing);
        }
        if self.zoom == 1.0 || response.double_clicked() {
            *self = Self::with_margin(self.margin_m);
        }
    }
}

/// The field as drawn in one frame.
pub struct FieldCanvas {
    pub painter: Painter,
    pub rect: Rect,
    pub response: Response,
    px_per_m: f32,
    middle_in_world: DVec2,
}

impl FieldCanvas {
    /// Returns the screen position of a position on the field.
    pub fn at(&self, place_in_world: DVec2) -> Pos2 {
        let offset = (place_in_world - self.middle_in_world) * f64::from(self.px_per_m);
        self.rect.center() + vec2(offset.x as f32, -offset.y as f32)
    }

    /// Returns the position on the field of a screen position.
    pub fn in_world(&self, position: Pos2) -> DVec2 {
        let offset = position - self.rect.center();
        self.middle_in_world
            + DVec2::new(f64::from(offset.x), f64::from(-offset.y)) / f64::from(self.px_per_m)
    }

    /// Converts a length on the field to points on the screen.
    pub fn points(&self, length_m: f64) -> f32 {
        length_m as f32 * self.px_per_m
    }

    /// Draws a path through positions, given every n-th frame, with gaps at steps too long for a walking robot.
    pub fn path(&self, places: &[DVec2], every: usize, stroke: impl Into<Stroke>) {
        let stroke = stroke.into();
        let longest_m = MAX_PATH_STEP_M * every as f64;
        for piece in places.chunk_by(|a, b| a.distance(*b) <= longest_m) {
            let points = piece.iter().map(|place| self.at(*place)).collect();
            self.painter.add(Shape::line(points, stroke));
        }
    }

    /// Draws the outline of the ground in view, see [`crate::footprint::footprint`].
    pub fn footprint(&self, outline: &[DVec2]) {
        if outline.len() >= 3 {
            let points: Vec<Pos2> = outline.iter().map(|&point| self.at(point)).collect();
            let stroke = Stroke::new(1.2, colors::BORDER.gamma_multiply(0.7));
            self.painter.add(Shape::closed_line(points, stroke));
        }
    }

    /// Draws an arrow at a pose, a tenth of the view long, with a dark rim.
    pub fn arrow(&self, pose: Pose2, color: Color32) {
        self.arrow_of_length(pose, color, self.arrow_length());
    }

    /// Draws an arrow of a length, points, at a pose, with a dark rim.
    pub fn arrow_of_length(&self, pose: Pose2, color: Color32, length: f32) {
        let tail = self.at(pose.position_in_world());
        let direction = vec2(pose.yaw_rad.cos() as f32, -pose.yaw_rad.sin() as f32);
        let (tip, side) = (tail + length * direction, direction.rot90());
        let barb = |sign: f32| tip - 0.35 * length * direction + sign * 0.2 * length * side;
        for stroke in [Stroke::new(5.0, Color32::from_black_alpha(150)), Stroke::new(2.5, color)] {
            self.painter.line_segment([tail, tip], stroke);
            self.painter.add(Shape::line(vec![barb(-1.0), tip, barb(1.0)], stroke));
            self.painter.circle(tail, 3.0, color, (stroke.width - 2.5, stroke.color));
        }
    }

    /// Writes a hint about the controls along the lower edge.
    pub fn hint(&self, text: &str) {
        if self.rect.width() < ROOM_FOR_HINT {
            return;
        }
        let corner = self.rect.right_bottom() - vec2(8.0, 6.0);
        let color = colors::LINE.gamma_multiply(0.6);
        self.painter.text(corner, Align2::RIGHT_BOTTOM, text, FontId::proportional(11.0), color);
    }

    /// Writes a text along the upper edge, on a dark ground.
    pub fn title(&self, text: &str) {
        let galley = self.painter.layout_no_wrap(text.to_owned(), FontId::proportional(14.0), colors::LINE);
        let ground = Align2::CENTER_TOP.anchor_size(self.rect.center_top() + vec2(0.0, 6.0), galley.size());
        self.painter.rect_filled(ground.expand2(vec2(8.0, 3.0)), 4.0, Color32::from_black_alpha(190));
        self.painter.galley(ground.min, galley, colors::LINE);
    }

    /// Returns the screen position of the tip of a pose's arrow.
    pub fn arrow_tip(&self, pose: Pose2) -> Pos2 {
        let direction = vec2(pose.yaw_rad.cos() as f32, -pose.yaw_rad.sin() as f32);
        self.at(pose.position_in_world()) + self.arrow_length() * direction
    }

    fn arrow_length(&self) -> f32 {
        (0.1 * self.rect.width().min(self.rect.height())).clamp(18.0, 60.0)
    }

    fn draw_carpet(&self, half_extent_m: DVec2) {
        let carpet = Rect::from_two_pos(self.at(-half_extent_m), self.at(half_extent_m));
        self.painter.rect_filled(self.rect, 0.0, colors::BESIDE);
        self.painter.rect_filled(carpet, 0.0, colors::CARPET);
    }

    /// Draws the field's lines at their true width, in one colour.
    pub fn draw_lines(&self, field: &FieldDimensions, color: Color32) {
        let stroke = Stroke::new(self.points(field.line_width_m).max(1.0), color);
        for curve in field.curves() {
            match curve {
                Curve::Segment { from, to } => {
                    self.painter.line_segment([self.at(from), self.at(to)], stroke);
                }
                Curve::Circle { center, radius_m } => {
                    self.painter.circle_stroke(self.at(center), self.points(radius_m), stroke);
                }
            }
        }
    }

    fn draw_goals(&self, field: &FieldDimensions) {
        let (x, y) = (0.5 * field.length_m, 0.5 * field.goal_width_m);
        let sides = [(x, field.goal_srgb_positive_x), (-x, field.goal_srgb_negative_x)];
        for (x, color) in sides {
            let [r, g, b] = color.unwrap_or([255, 255, 255]);
            let stroke = Stroke::new(
                (2.0 * self.points(field.goal_post_diameter_m)).max(3.0),
                Color32::from_rgb(r, g, b),
            );
            self.painter.line_segment([self.at(DVec2::new(x, -y)), self.at(DVec2::new(x, y))], stroke);
        }
    }

    /// Returns a part of the canvas that shows the ground around a position, this wide, metres.
    pub fn part(&self, rect: Rect, middle_in_world: DVec2, width_m: f64) -> Self {
        Self {
            painter: self.painter.with_clip_rect(rect.intersect(self.rect)),
            rect,
            response: self.response.clone(),
            px_per_m: rect.width() / width_m as f32,
            middle_in_world,
        }
    }

    /// Draws a scale bar of a round length, at most a quarter of the view, and writes the directions beside it.
    pub fn draw_scale(&self) {
        self.draw_scale_with(" · +x to the right, +y up");
    }

    /// Draws a scale bar of a round length, at most a quarter of the view, and writes a text after its length.
    pub fn draw_scale_with(&self, text: &str) {
        const LENGTHS: [(f64, &str); 7] = [
            (5.0, "5 m"),
            (1.0, "1 m"),
            (0.5, "50 cm"),
            (0.2, "20 cm"),
            (0.1, "10 cm"),
            (0.05, "5 cm"),
            (0.02, "2 cm"),
        ];
        let fits = |(length_m, _): &(f64, &str)| self.points(*length_m) < 0.25 * self.rect.width();
        let (length_m, name) = LENGTHS.into_iter().find(fits).unwrap_or(LENGTHS[LENGTHS.len() - 1]);
        let (corner, length) = (self.rect.left_bottom() + vec2(10.0, -10.0), self.points(length_m));
        let stroke = Stroke::new(1.5, colors::LINE);
        let font = FontId::proportional(11.0);
        let ends = [corner, corner + vec2(length, 0.0)];
        self.painter.line_segment(ends, stroke);
        for end in ends {
            self.painter.line_segment([end - vec2(0.0, 3.0), end + vec2(0.0, 3.0)], stroke);
        }
        let text = format!("{name}{text}");
        self.painter.text(corner - vec2(0.0, 4.0), Align2::LEFT_BOTTOM, text, font, colors::LINE);
    }
}
