//! All effects with the evidence, as tables.

use reality_sim_sensor::effect as library_effect;

use super::text::{capital, cell, channel_title, effect_cell, escape, number, table};
use crate::{
    report::data::{EffectReport, Estimate, Limit, NotFoundReport, Report, Unexplained, Unobservable},
    report::text::{amount, digits, percent, probability, with_sigma},
};

/// More are folded.
const MOST_PARAMETERS: usize = 5;

pub(super) fn section(report: &Report) -> String {
    let named = effects("What was found", &report.effects);
    let in_model = effects("What the model had before, refitted", &report.in_model);
    format!(
        "<h2>All effects</h2>\n{named}{in_model}{}{}",
        not_found(&report.not_found),
        unobservable(&report.unobservable)
    )
}

fn effects(title: &str, effects: &[EffectReport]) -> String {
    if effects.is_empty() {
        return String::new();
    }
    let rows: Vec<String> = effects.iter().map(effect).collect();
    let headings = ["Effect", "Size (95 %)", "Parameters (± 1 σ)", ">p", ">Held-out gain", "Closes alone"];
    format!("<h3>{title}</h3>\n{}", table(&headings, &rows))
}

/// Two rows: the numbers, and below them on what the name rests.
fn effect(effect: &EffectReport) -> String {
    let closes: Vec<String> = effect
        .closes
        .iter()
        .map(|(channel, part)| format!("<span class=\"one\">{} {}</span>", escape(channel), percent(*part)))
        .collect();
    format!(
        "<tr class=\"head\">{}{}<td>{}</td>{}{}<td>{}</td></tr><tr class=\"more\"><td colspan=\"6\"><span class=\"quiet\">Because \
         {}.{}</span></td></tr>",
        effect_cell(&effect.name, &effect.id),
        cell(&capital(&effect.size)),
        parameters(effect),
        number(&probability(effect.p_value)),
        number(&gain(&effect.held_out_gain)),
        if closes.is_empty() { "–".to_owned() } else { closes.join("<br/>") },
        escape(&effect.because),
        rivals(effect)
    )
}

/// Folded where they are many.
fn parameters(effect: &EffectReport) -> String {
    let text = |(name, estimate): (&String, &Estimate)| {
        let unit = estimate.unit.as_deref().filter(|unit| *unit != "1").unwrap_or("");
        let number = with_sigma(estimate.value, estimate.sigma);
        let number = escape(format!("{number} {unit}").trim_end());
        format!("<span class=\"one\"><code>{}</code> {number}</span>", escape(name))
    };
    let list = effect.parameters.iter().map(text).collect::<Vec<String>>().join("<br/>");
    let count = effect.parameters.len();
    if count > MOST_PARAMETERS {
        format!("<details><summary>{count} parameters</summary>{list}</details>")
    } else {
        list
    }
}

fn rivals(effect: &EffectReport) -> String {
    if effect.confusable_with.is_empty() {
        return String::new();
    }
    let rivals: Vec<String> =
        effect.confusable_with.iter().map(|id| format!("<code>{}</code>", escape(id))).collect();
    let recordings = effect.recording_that_would_decide.join("; or ");
    let remedy =
        if recordings.is_empty() { String::new() } else { format!(" To find out, {}.", escape(&recordings)) };
    format!(" These frames cannot tell it from {}.{remedy}", rivals.join(", "))
}

fn gain(gain: &Estimate) -> String {
    with_sigma(gain.value, gain.sigma)
}

fn not_found(effects: &[NotFoundReport]) -> String {
    if effects.is_empty() {
        return String::new();
    }
    let row = |effect: &NotFoundReport| {
        let words = effect.limit_in_words();
        let recording = library_effect(&effect.id).map_or("", |known| known.recording_that_would_decide());
        format!(
            "<tr>{}{}{}<td class=\"n\">{}{}</td>{}</tr>",
            effect_cell(&effect.name, &effect.id),
            number(&probability(effect.p_value)),
            number(&gain(&effect.held_out_gain)),
            escape(&words),
            if words.starts_with(&effect.parameter) { String::new() } else { as_in_model(effect) },
            cell(&capital(recording)),
        )
    };
    let rows: Vec<String> = effects.iter().map(row).collect();
    format!(
        "<h3>Not found</h3>\n{}",
        table(&["Effect", ">p", ">Held-out gain", ">Would have been found from", "To see less of it"], &rows)
    )
}

/// The limit as `model.toml` has it.
fn as_in_model(effect: &NotFoundReport) -> String {
    let Limit { value, unit } = &effect.detection_limit;
    let unit = if unit == "1" { "" } else { unit };
    let text = format!("{} {} {unit}", effect.parameter, digits(*value, 2));
    format!("<br/><code>{}</code>", escape(text.trim_end()))
}

fn unobservable(effects: &[Unobservable]) -> String {
    if effects.is_empty() {
        return String::new();
    }
    let row = |effect: &Unobservable| {
        let remedy = capital(&effect.recording_that_would_decide);
        format!(
            "<tr>{}{}{}</tr>",
            effect_cell(&effect.name, &effect.id),
            cell(&capital(&effect.reason)),
            cell(&remedy)
        )
    };
    let rows: Vec<String> = effects.iter().map(row).collect();
    format!(
        "<h3>Cannot be seen in these frames</h3>\n{}",
        table(&["Effect", "Why", "What would decide"], &rows)
    )
}

/// What no effect explains.
pub(super) fn unexplained(patterns: &[Unexplained]) -> String {
    if patterns.is_empty() {
        return "<h2>Unexplained</h2>\n<p>Nothing significant is left.</p>\n".to_owned();
    }
    let row = |pattern: &Unexplained| {
        format!(
            "<tr>{}{}{}{}</tr>",
            cell(&channel_title(&pattern.channel)),
            cell(&pattern.r#where),
            number(&amount(&pattern.channel, pattern.size, &pattern.unit, 2)),
            number(&pattern.p_value.map_or_else(String::new, probability))
        )
    };
    let rows: Vec<String> = patterns.iter().map(row).collect();
    format!("<h2>Unexplained</h2>\n{}", table(&["Channel", "Where", ">Size", ">p"], &rows))
}
