//! Labels over a picture: classes as tints, boxes with names, lines and crossings.

use eframe::egui::{Align2, Color32, FontId, Painter, Rect, Stroke, StrokeKind, Vec2, vec2};
use glam::DVec2;
use image::RgbImage;
use reality_sim_simulator::{Class, PixelBox, SeenObject, labels::Labels};

use crate::picture_view::PictureCanvas;

/// Share of a class's colour in the pixels that it tints, as in the picture of docs/dataset.md.
const TINT: f32 = 0.45;
/// Colour of the lines' centres.
const LINE_CENTRE: Color32 = Color32::from_rgb(120, 0, 90);
/// Colour of crossings and marks in view.
const CROSSING: Color32 = Color32::from_rgb(255, 0, 0);
/// Radius of the ring around a crossing, points.
const RING: f32 = 4.0;

/// Least width of a picture, points, in which names leave something of it to be seen.
const ROOM_FOR_NAMES: f32 = 320.0;

/// Classes in the order of the legend.
pub const CLASSES: [Class; 6] = Class::ALL;

/// Returns the colour of a class, sRGB: those of the picture of docs/dataset.md, and a dark one for what lies outside.
fn class_srgb(class: Class) -> [u8; 3] {
    match class {
        Class::Outside => [40, 40, 56],
        Class::Carpet => [60, 200, 90],
        Class::Line => [255, 60, 160],
        Class::Goal => [255, 210, 0],
        Class::Ball => [255, 120, 0],
        Class::Robot => [40, 140, 255],
    }
}

/// Returns the colour of a class on the screen.
pub fn class_color(class: Class) -> Color32 {
    let [red, green, blue] = class_srgb(class);
    Color32::from_rgb(red, green, blue)
}

/// Tints the pixels of a picture by their classes; a picture of another size stays as it is.
pub fn tint(picture: &mut RgbImage, labels: &Labels) {
    if picture.dimensions() != (labels.width, labels.height) {
        return;
    }
    for (pixel, class) in picture.pixels_mut().zip(&labels.classes) {
        for (value, color) in pixel.0.iter_mut().zip(class_srgb(*class)) {
            *value = ((1.0 - TINT) * f32::from(*value) + TINT * f32::from(color)).round() as u8;
        }
    }
}

/// Thing in view, as its label says.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkedThing {
    pub class: Class,
    /// Name with the share of the thing that nothing hides.
    pub words: String,
    pub around: PixelBox,
}

/// Labels that are drawn as lines: things in view, the field's lines, its crossings and marks.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Marks {
    pub things: Vec<MarkedThing>,
    /// Centres of lines in view, pixels.
    pub lines: Vec<Vec<DVec2>>,
    /// Crossings and marks in the picture, pixels, and whether nothing stands before them.
    pub crossings: Vec<(DVec2, bool)>,
}

impl Marks {
    /// Takes what is drawn of a picture's labels.
    pub fn of(labels: &Labels) -> Self {
        let thing = |seen: &SeenObject| {
            let words = format!("{} {:.0} %", seen.name, 100.0 * seen.visibility());
            Some(MarkedThing { class: seen.class, words, around: seen.visible? })
        };
        Self {
            things: labels.things.iter().filter_map(thing).collect(),
            lines: labels.lines.iter().map(|line| line.pixels.clone()).collect(),
            crossings: labels
                .crossings
                .iter()
                .filter_map(|seen| Some((seen.pixel?, seen.is_visible)))
                .collect(),
        }
    }

    /// Returns the things in view in words, for screen readers.
    pub fn in_words(&self) -> String {
        let words: Vec<&str> = self.things.iter().map(|thing| thing.words.as_str()).collect();
        format!("labels: {}", if words.is_empty() { "nothing in view".to_owned() } else { words.join(", ") })
    }

    /// Draws the marks over their picture, in the part of it that is shown.
    pub fn draw(&self, canvas: &PictureCanvas, shown: Rect) {
        let painter = canvas.painter.with_clip_rect(shown);
        for line in &self.lines {
            let points = line.iter().map(|&pixel| canvas.at(pixel)).collect();
            painter.line(points, Stroke::new(1.0, LINE_CENTRE));
        }
        for &(pixel, is_visible) in &self.crossings {
            let color = if is_visible { CROSSING } else { Color32::BLACK };
            painter.circle_stroke(canvas.at(pixel), RING, Stroke::new(1.5, color));
        }
        for thing in &self.things {
            let (rect, color) = (thing.rect(canvas), class_color(thing.class));
            let rim = Stroke::new(3.0, Color32::from_black_alpha(120));
            painter.rect_stroke(rect, 0.0, rim, StrokeKind::Outside);
            painter.rect_stroke(rect, 0.0, Stroke::new(1.5, color), StrokeKind::Outside);
        }
        if canvas.rect.width() >= ROOM_FOR_NAMES {
            self.draw_names(canvas, &painter);
        }
    }

    /// Writes the names beside the boxes, those of objects first: where there is no room for all, goals are told by their boxes.
    fn draw_names(&self, canvas: &PictureCanvas, painter: &Painter) {
        let mut taken: Vec<Rect> = Vec::new();
        for thing in self.things.iter().rev() {
            let font = FontId::proportional(11.0);
            let galley = painter.layout_no_wrap(thing.words.clone(), font, Color32::WHITE);
            let size = galley.size() + vec2(6.0, 2.0);
            if let Some(plate) = plate(thing.rect(canvas), size, canvas.rect, &taken) {
                painter.rect_filled(plate, 2.0, Color32::from_black_alpha(170));
                painter.galley(plate.min + vec2(3.0, 1.0), galley, Color32::WHITE);
                taken.push(plate);
            }
        }
    }
}

impl MarkedThing {
    /// Returns the box around the thing's pixels, whose centres have whole coordinates, on the screen.
    fn rect(&self, canvas: &PictureCanvas) -> Rect {
        let PixelBox { left, top, right, bottom } = self.around;
        let [min, max] = [[left, top], [right, bottom]]
            .map(|[u, v]| canvas.at(DVec2::new(f64::from(u), f64::from(v)) - 0.5));
        Rect::from_min_max(min, max)
    }
}

/// Returns where a name goes, inside the picture and beside names that are there: above its box, below it, or in it.
fn plate(around: Rect, size: Vec2, picture: Rect, taken: &[Rect]) -> Option<Rect> {
    let corners = [
        (Align2::LEFT_BOTTOM, around.left_top() - vec2(0.0, 2.0)),
        (Align2::LEFT_TOP, around.left_bottom() + vec2(0.0, 2.0)),
        (Align2::LEFT_TOP, around.left_top() + vec2(2.0, 2.0)),
    ];
    let places = corners.into_iter().map(|(align, corner)| {
        let place = align.anchor_size(corner, size);
        place.translate(vec2((picture.right() - place.right()).min(0.0), 0.0))
    });
    let is_free =
        |place: &Rect| picture.contains_rect(*place) && !taken.iter().any(|other| other.intersects(*place));
    places.into_iter().find(is_free)
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;

    use super::*;

    fn labels(classes: Vec<Class>) -> Labels {
        Labels { width: classes.len() as u32, height: 1, classes, ..Labels::default() }
    }

    #[test]
    fn every_class_has_a_tint_of_its_own() {
        let classes: Vec<Class> = Class::ALL.to_vec();
        let mut picture = RgbImage::from_pixel(6, 1, image::Rgb([100, 100, 100]));
        tint(&mut picture, &labels(classes));
        // 0.55 of 100 and 0.45 of the ball's orange.
        assert_eq!(picture.get_pixel(4, 0).0, [170, 109, 55]);
        let mut tints: Vec<[u8; 3]> = picture.pixels().map(|pixel| pixel.0).collect();
        tints.sort_unstable();
        tints.dedup();
        assert_eq!(tints.len(), 6);
    }

    #[test]
    fn a_picture_of_another_size_stays_as_it_is() {
        let mut picture = RgbImage::from_pixel(3, 1, image::Rgb([9, 8, 7]));
        tint(&mut picture, &labels(vec![Class::Ball; 2]));
        assert!(picture.pixels().all(|pixel| pixel.0 == [9, 8, 7]));
    }

    #[test]
    fn only_what_is_in_view_is_marked() {
        let seen = |name: &str, visible: Option<PixelBox>| SeenObject {
            class: Class::Robot,
            name: name.to_owned(),
            visible,
            whole: None,
            visible_pixels: 3,
            whole_pixels: 4,
            truncation: 0.0,
        };
        let labels = Labels {
            things: vec![seen("robot_1", Some(PixelBox::around(3, 4))), seen("robot_2", None)],
            ..Labels::default()
        };
        let marks = Marks::of(&labels);
        assert_eq!(marks.in_words(), "labels: robot_1 75 %");
        assert_eq!(Marks::default().in_words(), "labels: nothing in view");
    }

    #[test]
    fn names_stay_inside_the_picture_and_beside_each_other() {
        let picture = Rect::from_min_max(pos2(10.0, 10.0), pos2(210.0, 110.0));
        let (size, mut taken) = (vec2(50.0, 12.0), Vec::new());
        // In the middle, at the upper edge, at the right one, and twice where another one is.
        for at in [pos2(60.0, 60.0), pos2(120.0, 12.0), pos2(190.0, 60.0), pos2(62.0, 61.0), pos2(63.0, 62.0)]
        {
            let around = Rect::from_min_size(at, vec2(15.0, 30.0));
            let plate = plate(around, size, picture, &taken).unwrap();
            assert!(picture.contains_rect(plate), "{plate:?}");
            assert!(taken.iter().all(|other| !plate.intersects(*other)), "{plate:?} {taken:?}");
            taken.push(plate);
        }
        let around = Rect::from_min_size(pos2(61.0, 61.0), vec2(15.0, 30.0));
        assert_eq!(plate(around, size, picture, &taken), None, "there is no room left");
    }
}
