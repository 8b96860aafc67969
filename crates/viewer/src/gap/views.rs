//! Pictures, maps and course on one page, in a two-by-two grid.

use eframe::egui::{Align, ComboBox, Layout, Ui, Vec2, vec2};
use reality_sim_gap::{
    Channel,
    report::{
        Maps,
        text::{channel_meaning, channel_title},
    },
};

use super::{
    course,
    loaded::Loaded,
    maps::{MapViews, Shown},
    pictures::Pictures,
    ramp::Ramp,
    settings::GapSettings,
    side::Side,
    title::TITLE_HEIGHT,
};
use crate::shortcuts::{self, Action};

/// Width of the legend, points.
const LEGEND: f32 = 190.0;

/// State of the views kept from frame to frame.
#[derive(Default)]
pub struct Views {
    pictures: Pictures,
    maps: MapViews,
}

impl Views {
    /// Draws the views.
    pub fn ui(&mut self, ui: &mut Ui, loaded: &Loaded, settings: &mut GapSettings) {
        pictures_choice_ui(ui, loaded, settings);
        let maps = settings.channel.and_then(|channel| Some((channel, loaded.report.maps.get(&channel)?)));
        let ramp = maps.and_then(|(_, maps): (Channel, &Maps)| {
            let values = [&maps.picture, &maps.field].map(|map| map.before.iter().chain(&map.after));
            Ramp::of(values.into_iter().flatten().flatten().copied())
        });
        channel_choice_ui(ui, loaded, &mut settings.channel, ramp);
        let gap = ui.spacing().item_spacing;
        let room = ui.available_size();
        let view = vec2(0.5 * (room.x - gap.x), 0.5 * (room.y - gap.y) - TITLE_HEIGHT - gap.y)
            .max(Vec2::splat(60.0));
        let side = settings.side;
        let shown = maps.map(|(channel, maps)| Shown { channel, maps, side, ramp, room: view });
        row(
            ui,
            view,
            |ui| self.pictures.ui(ui, loaded, settings, view),
            |ui| match shown {
                Some(shown) => self.maps.picture_ui(ui, loaded, shown),
                None => nothing(ui, "no maps in this report"),
            },
        );
        row(
            ui,
            view,
            |ui| match shown {
                Some(shown) => self.maps.field_ui(ui, loaded, shown),
                None => nothing(ui, ""),
            },
            |ui| match maps {
                Some((channel, maps)) => course::ui(ui, &maps.time, channel, view),
                None => nothing(ui, ""),
            },
        );
    }
}

/// Draws two views side by side.
fn row(ui: &mut Ui, view: Vec2, left: impl FnOnce(&mut Ui), right: impl FnOnce(&mut Ui)) {
    let size = view + vec2(0.0, TITLE_HEIGHT + ui.spacing().item_spacing.y);
    ui.horizontal_top(|ui| {
        let flow = Layout::top_down(Align::Min);
        ui.allocate_ui_with_layout(size, flow, |ui| {
            ui.set_min_size(size);
            left(ui);
        });
        ui.allocate_ui_with_layout(size, flow, |ui| {
            ui.set_min_size(size);
            right(ui);
        });
    });
}

fn nothing(ui: &mut Ui, text: &str) {
    ui.weak(text);
}

/// Shows the choices of the model, and of wipe or difference.
fn pictures_choice_ui(ui: &mut Ui, loaded: &Loaded, settings: &mut GapSettings) {
    ui.horizontal_wrapped(|ui| {
        let key = shortcuts::name(ui, Action::OtherModel);
        for side in Side::ALL {
            let hover = format!("{} ({key} for the other)", side.meaning());
            ui.selectable_value(&mut settings.side, side, side.name()).on_hover_text(hover);
        }
        if loaded.report.effects.is_empty() {
            ui.weak("(none was found)").on_hover_text("No effect was found: both are the given model");
        }
        ui.separator();
        let key = shortcuts::name(ui, Action::Difference);
        for (is_difference, name, meaning) in [
            (false, "Wipe", "The measured picture left of a line to drag, the simulated one right of it"),
            (true, "Difference", "Measured minus simulated brightness, pixel by pixel"),
        ] {
            let hover = format!("{meaning} ({key} for the other)");
            ui.selectable_value(&mut settings.is_difference, is_difference, name).on_hover_text(hover);
        }
    });
}

/// Shows the choice of the channel, and its colours.
fn channel_choice_ui(ui: &mut Ui, loaded: &Loaded, chosen: &mut Option<Channel>, ramp: Option<Ramp>) {
    ui.horizontal_wrapped(|ui| {
        let label = ui.label("Residuals of");
        let now = *chosen;
        let title = now.map_or("", channel_title);
        let list = ComboBox::from_id_salt("channel").width(110.0).selected_text(title);
        let list = list.show_ui(ui, |ui| {
            for &channel in loaded.report.maps.keys() {
                ui.selectable_value(chosen, Some(channel), channel_title(channel))
                    .on_hover_text(channel_meaning(channel));
            }
        });
        list.response.labelled_by(label.id).on_hover_text(now.map_or("", channel_meaning));
        match now.zip(ramp) {
            Some((channel, ramp)) => ramp.legend_ui(ui, channel, LEGEND),
            None => drop(ui.weak("too few measurements in any place for a map")),
        }
    });
}
