//! The gap of each channel: before, after, and the noise floor.

use eframe::egui::{Button, Rect, Role, Sense, Stroke, Ui, WidgetInfo, vec2};
use reality_sim_gap::{
    Channel, ChannelGap,
    report::{
        Gap,
        text::{amount, channel_meaning, channel_title, percent},
    },
};

use super::{side::Side, table::Table};

/// Least width, points, of tables with room for bars.
const ROOM_FOR_BARS: f32 = 380.0;

/// Draws the table; a click on a name shows where the channel's residuals are.
pub fn ui(ui: &mut Ui, gap: &Gap, chosen: &mut Option<Channel>) {
    let wide: &[_] = &[("channel", 0.24), ("before", 0.15), ("after", 0.15), ("floor", 0.24), ("", 0.22)];
    let narrow: &[_] = &[("channel", 0.34), ("before", 0.2), ("after", 0.2), ("floor", 0.26)];
    let table = Table(if ui.available_width() > ROOM_FOR_BARS { wide } else { narrow });
    table.heads_ui(ui);
    for (&channel, gap) in &gap.channels {
        let size = |size| amount(channel, size, channel.unit(), 3);
        table.row_ui(ui, |ui, column| match column {
            0 => {
                let is_chosen = *chosen == Some(channel);
                let button = Button::selectable(is_chosen, channel_title(channel)).truncate();
                if ui.add(button).on_hover_text(channel_meaning(channel)).clicked() {
                    *chosen = Some(channel);
                }
            }
            1 => drop(ui.label(size(gap.before))),
            2 => drop(ui.label(size(gap.after))),
            3 => drop(ui.label(size(gap.floor))),
            _ => bars_ui(ui, channel, gap),
        });
    }
}

/// Draws the bar before above the bar after, and the noise floor as a line across both.
fn bars_ui(ui: &mut Ui, channel: Channel, gap: &ChannelGap) {
    let ChannelGap { before, after, floor, left_out } = gap;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    let size = |size| amount(channel, size, channel.unit(), 3);
    let text = format!(
        "before {}, after {}, noise alone {}; {} of the measurements left out",
        size(*before),
        size(*after),
        size(*floor),
        percent(*left_out)
    );
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
    let longest = before.max(*after).max(*floor).max(f64::MIN_POSITIVE);
    let width = |size: f64| rect.width() * (size / longest).clamp(0.0, 1.0) as f32;
    for (row, side) in Side::ALL.into_iter().enumerate() {
        let corner = rect.min + vec2(0.0, 1.0 + 7.5 * row as f32);
        let bar = Rect::from_min_size(corner, vec2(width(*side.of(&[*before, *after])), 6.0));
        ui.painter().rect_filled(bar, 1.0, side.color());
    }
    let stroke = Stroke::new(1.5, ui.visuals().strong_text_color());
    ui.painter().vline(rect.left() + width(*floor), rect.y_range(), stroke);
    response.on_hover_text(format!("{text}\norange: before · green: after · line: what noise alone makes"));
}
