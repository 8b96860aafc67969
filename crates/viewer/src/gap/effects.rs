//! The effects found, one per row, and the details of the selected one.

use eframe::egui::{Button, Label, ProgressBar, RichText, Ui};
use reality_sim_gap::report::{
    EffectReport,
    text::{
        channel_title, deciding_recordings, effect_because, effect_name, effect_size, estimate, percent,
        plain_probability,
    },
};

use super::table::Table;

/// Draws the table; a click selects an effect.
pub fn ui(ui: &mut Ui, name: &str, effects: &[EffectReport], chosen: &mut Option<String>) {
    if effects.is_empty() {
        return;
    }
    let table = Table(&[("effect", 0.44), ("p", 0.18), ("held-out gain", 0.38)]);
    ui.push_id(name, |ui| {
        table.heads_ui(ui);
        for effect in effects {
            table.row_ui(ui, |ui, column| match column {
                0 => name_ui(ui, effect, chosen),
                1 => {
                    ui.label(plain_probability(effect.p_value)).on_hover_text(
                        "How unlikely it is chance, corrected for the number of effects tested",
                    );
                }
                _ => {
                    ui.label(estimate(&effect.held_out_gain))
                        .on_hover_text("Gain in log-likelihood on frames that the fit has not seen");
                }
            });
        }
        if let Some(effect) = effects.iter().find(|effect| chosen.as_ref() == Some(&effect.id)) {
            details_ui(ui, effect);
        }
    });
}

fn name_ui(ui: &mut Ui, effect: &EffectReport, chosen: &mut Option<String>) {
    let is_chosen = chosen.as_ref() == Some(&effect.id);
    let button = Button::selectable(is_chosen, RichText::new(effect_name(effect)).strong()).wrap();
    if ui.add(button).on_hover_text(format!("{}: what it does, and why it was named", effect.id)).clicked() {
        *chosen = Some(effect.id.clone());
    }
}

/// Draws the details of an effect.
fn details_ui(ui: &mut Ui, effect: &EffectReport) {
    ui.group(|ui| {
        ui.set_width(ui.available_width());
        ui.add(Label::new(RichText::new(effect_size(effect)).strong()).wrap());
        ui.add(Label::new(format!("Because {}.", effect_because(effect))).wrap());
        for (name, value) in &effect.parameters {
            ui.add(Label::new(format!("{name} = {}", estimate(value))).wrap());
        }
        closes_ui(ui, effect);
        if effect.confusable_with.is_empty() {
            ui.weak("Nothing else explains these frames as well.");
        } else {
            let others = effect.confusable_with.join(", ");
            ui.add(Label::new(format!("These frames cannot tell it from: {others}")).wrap());
        }
        for recording in deciding_recordings(effect) {
            ui.add(Label::new(format!("To decide, record: {recording}")).wrap());
        }
    });
}

/// Draws how much of the distance to the noise floor an effect closes.
fn closes_ui(ui: &mut Ui, effect: &EffectReport) {
    if effect.closes.is_empty() {
        return;
    }
    ui.weak("Of the distance to the noise floor it alone closes:");
    for (channel, share) in &effect.closes {
        let text = format!("{} {}", channel_title(*channel), percent(*share));
        ui.add(ProgressBar::new(share.clamp(0.0, 1.0) as f32).desired_height(16.0).text(text));
    }
}
