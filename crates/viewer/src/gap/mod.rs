//! Gap: where a camera's simulation and its pictures disagree, which effects are missing, and how much they explain.
//!
//! A report is [`loaded`] once, by the thread that opens it; everything else only draws. [`pictures`], [`maps`] and
//! [`course`] are the views; [`evidence`], [`channels`] and [`effects`] form the panel beside them.

mod channels;
mod course;
mod effects;
mod evidence;
mod header;
mod loaded;
mod maps;
mod pictures;
mod ramp;
mod settings;
mod side;
mod table;
mod title;
mod views;

use eframe::egui::{self, Ui};

use self::views::Views;
pub use self::{loaded::Loaded, settings::GapSettings};
use crate::shortcuts::{self, Action, Place};

/// Share of the width that the evidence takes, within these widths, points.
const EVIDENCE_SHARE: f32 = 0.36;
const EVIDENCE_WIDTHS: std::ops::RangeInclusive<f32> = 270.0..=520.0;

/// Report, and the selection in it.
pub struct GapPanel {
    loaded: Loaded,
    views: Views,
    /// Id of the effect whose details are shown.
    effect: Option<String>,
}

impl GapPanel {
    /// Makes the panel, showing the surest effect first.
    pub fn new(loaded: Loaded) -> Self {
        let effect = loaded.effects().next().map(|effect| effect.id.clone());
        Self { loaded, views: Views::default(), effect }
    }

    /// Shows the panel.
    pub fn ui(&mut self, ui: &mut Ui, settings: &mut GapSettings) {
        settings.channel = settings
            .channel
            .filter(|channel| self.loaded.report.maps.contains_key(channel))
            .or_else(|| self.loaded.widest_channel());
        for action in shortcuts::pressed(ui, Place::Gap) {
            self.act(action, settings);
        }
        egui::Panel::top("gap verdict").show(ui, |ui| header::ui(ui, &self.loaded.report));
        let width = ui.available_width();
        let evidence_width = (EVIDENCE_SHARE * width).clamp(*EVIDENCE_WIDTHS.start(), *EVIDENCE_WIDTHS.end());
        egui::Panel::right("gap evidence").resizable(false).exact_size(evidence_width).show(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                evidence::ui(ui, &self.loaded.report, &mut settings.channel, &mut self.effect);
            });
        });
        egui::CentralPanel::default().show(ui, |ui| self.views.ui(ui, &self.loaded, settings));
    }

    fn act(&mut self, action: Action, settings: &mut GapSettings) {
        match action {
            Action::OtherModel => settings.side = settings.side.other(),
            Action::Difference => settings.is_difference = !settings.is_difference,
            Action::ChannelBefore | Action::ChannelAfter => {
                let channels = self.loaded.report.maps.keys().copied();
                settings.channel = neighbour(channels, settings.channel, action == Action::ChannelAfter);
            }
            Action::EffectAbove | Action::EffectBelow => {
                let effects = self.loaded.effects().map(|effect| effect.id.clone());
                self.effect = neighbour(effects, self.effect.take(), action == Action::EffectBelow);
            }
            _ => {}
        }
    }
}

/// Returns the entry after or before `one` in a list, or `one` itself at the ends.
fn neighbour<T: PartialEq>(all: impl Iterator<Item = T>, one: Option<T>, is_after: bool) -> Option<T> {
    let one = one?;
    let mut all: Vec<T> = all.collect();
    let place = all.iter().position(|other| *other == one).unwrap_or(0);
    let wanted = if is_after { place + 1 } else { place.saturating_sub(1) };
    if wanted < all.len() { Some(all.swap_remove(wanted)) } else { Some(one) }
}
