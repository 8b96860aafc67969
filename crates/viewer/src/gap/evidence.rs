//! The evidence from top to bottom: effects found, the gap, what remains, things on the carpet, effects not found, and
//! unobservable effects.

use eframe::egui::{Label, RichText, Ui};
use reality_sim_gap::{
    Channel,
    report::{
        Finding, NotFoundReport, Object, Report, Unobservable,
        text::{
            channel_title, estimate, finding_place, finding_size, hidden_carpet, library_name, limit,
            object_place, percent, plain_probability, unobservable_reason, unobservable_remedy,
        },
    },
};

use super::{
    channels, effects,
    table::{Table, title},
};

/// Shows the evidence. `channel` and `effect` are the selected ones.
pub fn ui(ui: &mut Ui, report: &Report, channel: &mut Option<Channel>, effect: &mut Option<String>) {
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
    if !report.objects.is_empty() {
        title(ui, "Things on the carpet");
        objects_ui(ui, &report.objects);
    }
    title(ui, "Not found");
    not_found_ui(ui, &report.not_found);
    if !report.unobservable.is_empty() {
        title(ui, "Cannot be seen in these frames");
        report.unobservable.iter().for_each(|effect| unobservable_ui(ui, effect));
    }
    ui.add_space(8.0);
}

fn unexplained_ui(ui: &mut Ui, unexplained: &[Finding]) {
    if unexplained.is_empty() {
        ui.weak("nothing significant");
        return;
    }
    let table = Table(&[("channel", 0.22), ("where", 0.4), ("size", 0.21), ("p", 0.17)]);
    table.heads_ui(ui);
    for finding in unexplained {
        let p_value = finding.p_value().map_or_else(String::new, plain_probability);
        let channel = channel_title(finding.channel());
        table.texts_ui(ui, &[channel, &finding_place(finding), &finding_size(finding), &p_value]);
    }
}

fn objects_ui(ui: &mut Ui, objects: &[Object]) {
    let table = Table(&[("where", 0.55), ("carpet hidden", 0.25), ("in pictures", 0.2)]);
    table.heads_ui(ui);
    for object in objects {
        table.texts_ui(ui, &[&object_place(object), &hidden_carpet(object), &percent(object.pictures)]);
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
        table.row_ui(ui, |ui, column| match column {
            0 => {
                ui.add(Label::new(library_name(&effect.id)).wrap()).on_hover_text(&effect.id);
            }
            1 => {
                ui.label(limit(effect)).on_hover_text(format!("{} of {}", effect.parameter, effect.id));
            }
            _ => {
                ui.label(plain_probability(effect.p_value))
                    .on_hover_text(format!("Held-out gain {}", estimate(&effect.held_out_gain)));
            }
        });
    }
}

fn unobservable_ui(ui: &mut Ui, effect: &Unobservable) {
    ui.add(Label::new(RichText::new(library_name(&effect.id)).strong()).wrap()).on_hover_text(&effect.id);
    ui.add(Label::new(unobservable_reason(&effect.cause)).wrap());
    ui.add(Label::new(format!("What would decide: {}", unobservable_remedy(effect))).wrap());
    ui.add_space(4.0);
}
