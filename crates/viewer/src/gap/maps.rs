//! Maps of the residuals: in the picture, and on the field from above.

use eframe::egui::{Color32, Rect, Response, Ui, Vec2};
use glam::DVec2;
use reality_sim_gap::{
    Channel,
    report::{Map, Maps, text::amount},
};

use super::{loaded::Loaded, ramp::Ramp, side::Side, table::words, title::title_ui};
use crate::{
    field_view::FieldView,
    picture_view::{PictureCanvas, Uploaded},
};

/// Opacity of the cells.
const COVER: f32 = 0.82;
/// Brightness of the picture below the cells, 0 to 255.
const BACKGROUND: u8 = 110;
/// Grey of the field's lines, visible on carpet and on pale cells alike.
const LINES: u8 = 125;

/// Data of a channel's maps.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    pub channel: Channel,
    pub maps: &'a Maps,
    pub side: Side,
    /// Colours of the values; `None` if there are too few values.
    pub ramp: Option<Ramp>,
    /// Size of the view.
    pub room: Vec2,
}

impl Shown<'_> {
    /// Returns the colours for a map in which something was measured.
    fn ramp_of(&self, map: &Map) -> Option<Ramp> {
        self.ramp.filter(|_| has_values(map, self.side))
    }
}

/// State of the maps kept from frame to frame.
#[derive(Default)]
pub struct MapViews {
    background: Uploaded,
    field: FieldView,
}

impl MapViews {
    /// Shows residuals over the picture.
    pub fn picture_ui(&mut self, ui: &mut Ui, loaded: &Loaded, shown: Shown<'_>) {
        let Shown { channel, maps, side, room, .. } = shown;
        title_ui(ui, &format!("In the picture, {}", side.name()), "Medians of measured minus simulated");
        let map = &maps.picture;
        let Some(ramp) = shown.ramp_of(map) else { return nowhere(ui, room) };
        let [left, top, right, bottom] = map.extent;
        let corner = DVec2::new(left, top);
        let size = [right - left, bottom - top].map(|side| side.abs() as usize);
        let name = format!("residuals in the picture {}", side.name());
        let canvas = PictureCanvas::allocate(ui, size, room, &name);
        if let Some(measured) = &loaded.measured {
            let texture = self.background.texture(ui.ctx(), measured);
            canvas.draw(texture, Color32::from_gray(BACKGROUND));
        }
        // A pixel's centre has integer coordinates; the extent is given by the pixels' edges.
        let at = |place: DVec2| canvas.at(place - corner - 0.5);
        for cell in cells(map, side) {
            let rect = Rect::from_two_pos(at(cell.corners[0]), at(cell.corners[1]));
            canvas.painter.rect_filled(rect, 0.0, ramp.color(cell.value).gamma_multiply(COVER));
        }
        hover(&canvas.response, map, side, channel, |cell| Rect::from_two_pos(at(cell[0]), at(cell[1])));
    }

    /// Shows residuals over the field from above.
    pub fn field_ui(&mut self, ui: &mut Ui, loaded: &Loaded, shown: Shown<'_>) {
        let Shown { channel, maps, side, room, .. } = shown;
        let field = &loaded.report.field;
        let more = format!(
            "Medians of measured minus simulated, with the lines of the field “{}”. Wheel: zoom · secondary button: move",
            field.name
        );
        title_ui(ui, &format!("On the field, {}", side.name()), &more);
        let map = &maps.field;
        let Some(ramp) = shown.ramp_of(map) else { return nowhere(ui, room) };
        let [left, top, right, bottom] = map.extent;
        let half = DVec2::new(left.abs().max(right.abs()), top.abs().max(bottom.abs()));
        let name = format!("residuals on the field {}", side.name());
        let canvas = self.field.show_carpet(ui, half, room, &name);
        for cell in cells(map, side) {
            let rect = Rect::from_two_pos(canvas.at(cell.corners[0]), canvas.at(cell.corners[1]));
            canvas.painter.rect_filled(rect, 0.0, ramp.color(cell.value).gamma_multiply(COVER));
        }
        canvas.draw_lines(field, Color32::from_gray(LINES));
        canvas.draw_scale();
        hover(&canvas.response, map, side, channel, |cell| {
            Rect::from_two_pos(canvas.at(cell[0]), canvas.at(cell[1]))
        });
    }
}

/// Cell with a value: two opposite corners in the map's own axes.
struct Cell {
    corners: [DVec2; 2],
    value: f64,
}

fn has_values(map: &Map, side: Side) -> bool {
    side.of_map(map).iter().any(Option::is_some)
}

/// Iterates over the cells in which something was measured.
fn cells(map: &Map, side: Side) -> impl Iterator<Item = Cell> {
    let [left, top, right, bottom] = map.extent;
    let step = DVec2::new((right - left) / map.columns as f64, (bottom - top) / map.rows as f64);
    let values = side.of_map(map).iter().enumerate();
    values.filter_map(move |(place, value)| {
        let corner = DVec2::new((place % map.columns) as f64, (place / map.columns) as f64);
        let at = |corner: DVec2| DVec2::new(left, top) + corner * step;
        Some(Cell { corners: [at(corner), at(corner + 1.0)], value: (*value)? })
    })
}

/// Shows the value below the pointer.
fn hover(
    response: &Response,
    map: &Map,
    side: Side,
    channel: Channel,
    on_screen: impl Fn([DVec2; 2]) -> Rect,
) {
    let Some(pointer) = response.hover_pos() else { return };
    let below = cells(map, side).find(|cell| on_screen(cell.corners).contains(pointer));
    if let Some(Cell { value, .. }) = below {
        response.clone().on_hover_text_at_pointer(amount(channel, value, channel.unit(), 3));
    }
}

fn nowhere(ui: &mut Ui, room: Vec2) {
    words(ui, room, "too few measurements in any place for a map");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_fill_the_extent_row_by_row_from_its_first_corner() {
        let values: Vec<Option<f64>> = (0..6).map(|value| (value != 4).then_some(f64::from(value))).collect();
        let map =
            Map { columns: 3, rows: 2, extent: [-3.0, 1.0, 3.0, -1.0], before: values, after: vec![None; 6] };
        let cells: Vec<Cell> = cells(&map, Side::Without).collect();
        assert_eq!(cells.iter().map(|cell| cell.value).collect::<Vec<_>>(), [0.0, 1.0, 2.0, 3.0, 5.0]);
        assert_eq!(cells[0].corners, [DVec2::new(-3.0, 1.0), DVec2::new(-1.0, 0.0)]);
        assert_eq!(cells[4].corners, [DVec2::new(1.0, 0.0), DVec2::new(3.0, -1.0)]);
        assert!(!has_values(&map, Side::With));
    }
}
