//! Tables of all effects with the evidence for them.

use reality_sim_sensor::effect as library_effect;

use super::text::{capital, cell, effect_cell, escape, number, table};
use crate::{
    diagnostics::{finding::Finding, object::Object},
    report::data::{EffectReport, Estimate, Limit, NotFoundReport, Report, Unobservable},
    report::text::{
        channel_title, deciding_recordings, digits, effect_because, effect_name, effect_size, estimate,
        finding_place, finding_size, hidden_carpet, library_name, limit, object_place, percent, probability,
        unobservable_reason, unobservable_remedy, with_sigma,
    },
};

/// Largest number of parameters that are shown unfolded.
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

/// Returns two rows for an effect: its numbers, and below them the evidence for its name.
fn effect(effect: &EffectReport) -> String {
    let closes: Vec<String> = effect
        .closes
        .iter()
        .map(|(channel, part)| format!("<span class=\"one\">{} {}</span>", channel.name(), percent(*part)))
        .collect();
    format!(
        "<tr class=\"head\">{}{}<td>{}</td>{}{}<td>{}</td></tr><tr class=\"more\"><td colspan=\"6\"><span class=\"quiet\">Because \
         {}.{}</span></td></tr>",
        effect_cell(effect_name(effect), &effect.id),
        cell(&capital(&effect_size(effect))),
        parameters(effect),
        number(&probability(effect.p_value)),
        number(&gain(&effect.held_out_gain)),
        if closes.is_empty() { "–".to_owned() } else { closes.join("<br/>") },
        escape(effect_because(effect)),
        confusable(effect)
    )
}

/// Lists an effect's parameters, folded if there are many.
fn parameters(effect: &EffectReport) -> String {
    let text = |(name, value): (&String, &Estimate)| {
        let number = escape(&estimate(value));
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

/// Returns the effects that this one is confusable with, and what to record to tell them apart; empty if there are none.
fn confusable(effect: &EffectReport) -> String {
    if effect.confusable_with.is_empty() {
        return String::new();
    }
    let others: Vec<String> =
        effect.confusable_with.iter().map(|id| format!("<code>{}</code>", escape(id))).collect();
    let recordings = deciding_recordings(effect).join("; or ");
    let remedy =
        if recordings.is_empty() { String::new() } else { format!(" To find out, {}.", escape(&recordings)) };
    format!(" These frames cannot tell it from {}.{remedy}", others.join(", "))
}

fn gain(gain: &Estimate) -> String {
    with_sigma(gain.value, gain.sigma)
}

fn not_found(effects: &[NotFoundReport]) -> String {
    if effects.is_empty() {
        return String::new();
    }
    let row = |effect: &NotFoundReport| {
        let words = limit(effect);
        let recording = library_effect(&effect.id).map_or("", |known| known.recording_that_would_decide());
        format!(
            "<tr>{}{}{}<td class=\"n\">{}{}</td>{}</tr>",
            effect_cell(library_name(&effect.id), &effect.id),
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

/// Returns a detection limit in the form of `model.toml`.
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
        format!(
            "<tr>{}{}{}</tr>",
            effect_cell(library_name(&effect.id), &effect.id),
            cell(&capital(unobservable_reason(&effect.cause))),
            cell(&capital(unobservable_remedy(effect)))
        )
    };
    let rows: Vec<String> = effects.iter().map(row).collect();
    format!(
        "<h3>Cannot be seen in these frames</h3>\n{}",
        table(&["Effect", "Why", "What would decide"], &rows)
    )
}

/// Returns the table of findings that no effect explains.
pub(super) fn unexplained(findings: &[Finding]) -> String {
    if findings.is_empty() {
        return "<h2>Unexplained</h2>\n<p>Nothing significant is left.</p>\n".to_owned();
    }
    let row = |finding: &Finding| {
        format!(
            "<tr>{}{}{}{}</tr>",
            cell(channel_title(finding.channel())),
            cell(&finding_place(finding)),
            number(&finding_size(finding)),
            number(&finding.p_value().map_or_else(String::new, probability))
        )
    };
    let rows: Vec<String> = findings.iter().map(row).collect();
    format!("<h2>Unexplained</h2>\n{}", table(&["Channel", "Where", ">Size", ">p"], &rows))
}

/// Returns the table of things on the carpet; empty if there are none.
pub(super) fn objects(objects: &[Object]) -> String {
    if objects.is_empty() {
        return String::new();
    }
    let row = |object: &Object| {
        format!(
            "<tr>{}{}{}</tr>",
            cell(&capital(&object_place(object))),
            number(&hidden_carpet(object)),
            number(&percent(object.pictures))
        )
    };
    let rows: Vec<String> = objects.iter().map(row).collect();
    format!(
        "<h2>Things on the carpet</h2>\n{}<p class=\"quiet\">Robots, balls, people, goals and their shadows are ordinary: \
         what they hide counts for nothing.</p>\n",
        table(&["", ">Carpet hidden", ">In pictures"], &rows)
    )
}
