//! What the answer rests on, from top to bottom: what was found, the gap, what is left, what was not found, what cannot be seen.

use eframe::egui::{Label, RichText, Ui};
use reality_sim_gap::report::{NotFoundReport, Report, Unexplained, Unobservable};

use super::{
    channels, effects,
    table::{Table, title},
    words::{estimate, number, p_value, unit_after},
};

/// Shows it. `channel` and `effect` are those that are looked at.
pub fn ui(ui: &mut Ui, report: &Report, channel: &mut String, effect: &mut Option<String>) {
    title(ui, "Effects found");
    if report.effects.is_empty() {
        ui.weak("none");
    }
    effects::ui(ui, "found", &report.effects, effect);
    if !report.in_model.is_empty() {
        title(ui, "In the model before, refitted");
        effects::ui(ui, "in model", &report.in_model, effect);
    }
    title(ui, "Gap by channel");
    channels::ui(ui, &report.gap, channel);
    title(ui, "Unexplained");
    unexplained_ui(ui, &report.unexplained);
    title(ui, "Not found");
    not_found_ui(ui, &report.not_found);
    if !report.unobservable.is_empty() {
        title(ui, "Cannot be seen in these frames");
        report.unobservable.iter().for_each(|effect| unobservable_ui(ui, effect));
    }
    ui.add_space(8.0);
}

fn unexplained_ui(ui: &mut Ui, unexplained: &[Unexplained]) {
    if unexplained.is_empty() {
        ui.weak("nothing significant");
        return;
    }
    let table = Table(&[("channel", 0.22), ("where", 0.4), ("size", 0.21), ("p", 0.17)]);
    table.heads_ui(ui);
    for left in unexplained {
        let size = format!("{}{}", number(left.size), unit_after(&left.unit));
        table.texts_ui(
            ui,
            &[&left.channel, &left.r#where, &size, &left.p_value.map_or_else(String::new, p_value)],
        );
    }
}

fn not_found_ui(ui: &mut Ui, effects: &[NotFoundReport]) {
    if effects.is_empty() {
        ui.weak("none");
        return;
    }
    let table = Table(&[("effect", 0.55), ("would be found from", 0.28), ("p", 0.17)]);
    table.heads_ui(ui);
    for effect in effects {
        let limit = &effect.detection_limit;
        table.row_ui(ui, |ui, column| match column {
            0 => {
                ui.add(Label::new(&effect.name).wrap()).on_hover_text(&effect.id);
            }
            1 => {
                ui.label(format!("{}{}", number(limit.value), unit_after(&limit.unit)))
                    .on_hover_text(format!("{} of {}", effect.parameter, effect.id));
            }
            _ => {
                ui.label(p_value(effect.p_value))
                    .on_hover_text(format!("Held-out gain {}", estimate(&effect.held_out_gain)));
            }
        });
    }
}

fn unobservable_ui(ui: &mut Ui, effect: &Unobservable) {
    ui.add(Label::new(RichText::new(&effect.name).strong()).wrap()).on_hover_text(&effect.id);
    ui.add(Label::new(&effect.reason).wrap());
    if !effect.recording_that_would_decide.is_empty() {
        ui.add(Label::new(format!("To decide, record: {}", effect.recording_that_would_decide)).wrap());
    }
    ui.add_space(4.0);
}
