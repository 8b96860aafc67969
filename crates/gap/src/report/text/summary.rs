//! The verdict in a sentence.

use reality_sim_sensor::{Model, Role, effect, text::percent};

use super::number::{amount, closed};
use crate::report::data::{EffectReport, Gap, NotFoundReport, Unexplained, Unobservable, Verdict};

/// As many limits are named where nothing was found.
const LIMITS: usize = 3;
/// As many unexplained patterns, or effects that cannot be seen, are named.
const NAMED: usize = 2;

/// What a verdict is made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Findings<'a> {
    pub(crate) verdict: Verdict,
    /// Effects that were found.
    pub(crate) effects: &'a [EffectReport],
    /// Effects that the model had before, refitted, and as they were.
    pub(crate) in_model: &'a [EffectReport],
    pub(crate) given: &'a Model,
    pub(crate) unexplained: &'a [Unexplained],
    pub(crate) gap: &'a Gap,
    pub(crate) not_found: &'a [NotFoundReport],
    pub(crate) unobservable: &'a [Unobservable],
}

/// The verdict as one to a few sentences.
pub(crate) fn summary(findings: Findings<'_>) -> String {
    let verdict = match findings.verdict {
        Verdict::None => nothing(findings),
        Verdict::Named | Verdict::Confusable => named(findings),
        Verdict::Unknown if findings.effects.is_empty() => unknown(findings.unexplained),
        Verdict::Unknown => format!("{} {UNSURE} {}", unknown(findings.unexplained), named(findings)),
        Verdict::Inconclusive => inconclusive(findings.unobservable),
    };
    let refitted = findings.in_model.iter().filter_map(|effect| refitted(effect, findings.given));
    std::iter::once(verdict).chain(refitted).collect::<Vec<String>>().join(" ")
}

/// What is not explained may be a part of what was named.
const UNSURE: &str = "Effects of the library explain a part of it, not for sure while the rest is unknown:";
/// Sizes that are this many standard deviations from what they were are others.
const MOVED: f64 = 3.0;
/// An effect shows where it is no chance below this, or closes a part of the gap.
const SHOWS: f64 = 0.05;

/// An effect of the given model that these frames do not show, or show in another size.
fn refitted(report: &EffectReport, given: &Model) -> Option<String> {
    let known = effect(&report.id)?;
    let (name, size) = (&report.name, &report.size);
    if report.p_value > SHOWS && report.closes.is_empty() {
        return Some(format!("An effect of the model does not show in these frames, {name}: {size}."));
    }
    let was = given.values(&report.id)?;
    let moved = known.parameters().iter().zip(was).filter(|(parameter, _)| parameter.role == Role::Size).any(
        |(parameter, was)| {
            let now = report.parameters.get(parameter.name);
            now.is_some_and(|now| (now.value - was).abs() > (MOVED * now.sigma).max(parameter.material))
        },
    );
    moved.then(|| format!("An effect of the model has another size than was given, {name}: {size}."))
}

/// A sentence for each effect, and what they close.
fn named(findings: Findings<'_>) -> String {
    let (unsure, sure): (Vec<_>, Vec<_>) =
        findings.effects.iter().partition(|effect| !effect.confusable_with.is_empty());
    let mut sentences: Vec<String> =
        sure.iter().map(|effect| format!("{}: {}", effect.name, effect.size)).collect();
    sentences.extend(unsure.into_iter().map(either));
    let one = sentences.len() == 1;
    match (closing(findings), sentences.first_mut()) {
        (Some(closing), Some(only)) if one => only.push_str(&format!("; {closing}")),
        (Some(closing), _) => sentences.push(closing),
        _ => {}
    }
    sentences.iter().map(|text| sentence(text)).collect::<Vec<String>>().join(" ")
}

/// "adding it closes 93 % of the photometric gap": of every channel in which an effect closes most. One effect's part is
/// that of it alone, several effects' part that of all.
fn closing(findings: Findings<'_>) -> Option<String> {
    let Findings { effects, gap, .. } = findings;
    let subject = match effects {
        [] => return None,
        [effect] if effect.confusable_with.is_empty() => "it",
        [_] => "the first",
        [_, _] => "both",
        _ => "all of them",
    };
    let mut parts: Vec<(&str, f64)> = effects.iter().filter_map(|effect| most_closed(effect, gap)).collect();
    if effects.len() > 1 {
        for (channel, part) in &mut parts {
            let gap = gap.channels.get(*channel)?;
            *part = closed(gap.before, gap.after, gap.floor)?;
        }
    }
    parts.sort_by(|a, b| a.0.cmp(b.0));
    parts.dedup_by(|a, b| a.0 == b.0);
    let texts: Vec<String> = parts
        .into_iter()
        .map(|(channel, part)| format!("{} of the {} gap", percent(part), channel_adjective(channel)))
        .collect();
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    (!texts.is_empty()).then(|| format!("adding {subject} closes {}", enumerated(&texts)))
}

/// The channel whose distance to the noise floor, in noise floors, the effect shortens most, and by what part of it.
fn most_closed<'a>(effect: &'a EffectReport, gap: &Gap) -> Option<(&'a str, f64)> {
    let distance = |channel: &str| {
        let gap = gap.channels.get(channel);
        gap.map_or(0.0, |gap| (gap.before - gap.floor) / gap.floor.max(f64::MIN_POSITIVE))
    };
    let parts = effect.closes.iter().map(|(channel, part)| (channel.as_str(), *part));
    parts.max_by(|a, b| (a.1 * distance(a.0)).total_cmp(&(b.1 * distance(b.0))))
}

/// "Either A or B: these frames cannot tell; to find out, …".
fn either(effect_report: &EffectReport) -> String {
    let rivals =
        effect_report.confusable_with.iter().map(|id| effect(id).map_or(id.as_str(), |rival| rival.name()));
    let rivals: Vec<&str> = rivals.collect();
    let name =
        format!("{} ({})", effect_report.name, effect_report.size.replace(" (", ", ").replace(')', ""));
    let recordings = effect_report.recording_that_would_decide.join("; or ");
    let remedy = if recordings.is_empty() { String::new() } else { format!("; to find out, {recordings}") };
    format!("either {name} or {}: these frames cannot tell{remedy}", joined(&rivals, " or "))
}

/// A sentence for each of the first patterns.
fn unknown(unexplained: &[Unexplained]) -> String {
    let mut sentences = vec!["something is at work that no effect of the library explains".to_owned()];
    sentences.extend(unexplained.iter().take(NAMED).map(said));
    match unexplained.len().saturating_sub(NAMED) {
        0 => {}
        1 => sentences.push("there is one more pattern like these".to_owned()),
        more => sentences.push(format!("there are {more} more patterns like these")),
    }
    sentences.iter().map(|text| sentence(text)).collect::<Vec<String>>().join(" ")
}

/// "sharpness: in the picture left of the middle, in the lower part (0.13 px²)"; without its size where its place has a number.
fn said(pattern: &Unexplained) -> String {
    let place = &pattern.r#where;
    let amount = amount(&pattern.channel, pattern.size, &pattern.unit, 2);
    let amount = if place.contains(" %") { String::new() } else { format!(" ({amount})") };
    format!("{}: {place}{amount}", channel_noun(&pattern.channel))
}

/// What is not missing, from which size on, and how many effects nobody could tell of.
fn nothing(findings: Findings<'_>) -> String {
    let subject = match findings.in_model {
        [] => "Nothing is missing".to_owned(),
        known => {
            let known: Vec<&str> = known.iter().map(|effect| effect.id.as_str()).collect();
            format!("Nothing further is missing beside {} of the model", enumerated(&known))
        }
    };
    let shown = match shown_from(findings.not_found) {
        Some(limits) => format!("{subject}: these frames would have shown {limits}."),
        None => format!("{subject} that these frames would show."),
    };
    std::iter::once(shown).chain(not_judged(findings)).collect::<Vec<String>>().join(" ")
}

/// "9 of 22 effects cannot be judged, most of them because …".
fn not_judged(findings: Findings<'_>) -> Option<String> {
    let unobservable = findings.unobservable;
    let known = [findings.effects.len(), findings.in_model.len(), findings.not_found.len()];
    let all = unobservable.len() + known.iter().sum::<usize>();
    let times = |reason: &str| unobservable.iter().filter(|effect| effect.reason == reason).count();
    let usual =
        unobservable.iter().map(|effect| effect.reason.as_str()).max_by_key(|reason| times(reason))?;
    let most = if times(usual) < unobservable.len() { ", most of them" } else { "" };
    Some(format!("{} of {all} effects cannot be judged{most} because {usual}.", unobservable.len()))
}

/// "a loss of light at the corners from 3.0 % on and …".
fn shown_from(not_found: &[NotFoundReport]) -> Option<String> {
    let mut limits: Vec<(u32, String)> = not_found
        .iter()
        .filter(|report| report.detection_limit.value.is_finite())
        .filter_map(|report| {
            let about = effect(&report.id)?.about();
            Some((about.rank, format!("{} from {} on", about.noun, report.limit_in_words())))
        })
        .collect();
    limits.sort();
    limits.truncate(LIMITS);
    let limits: Vec<&str> = limits.iter().map(|(_, text)| text.as_str()).collect();
    (!limits.is_empty()).then(|| enumerated(&limits))
}

fn inconclusive(unobservable: &[Unobservable]) -> String {
    let names: Vec<String> =
        unobservable.iter().take(NAMED).map(|effect| format!("whether {}", effect.name)).collect();
    let mut recordings: Vec<&str> =
        unobservable.iter().take(NAMED).map(|effect| effect.recording_that_would_decide.as_str()).collect();
    recordings.retain(|recording| !recording.is_empty());
    recordings.dedup();
    if names.is_empty() {
        return "These frames cannot tell whether anything is missing.".to_owned();
    }
    let remedy = if recordings.is_empty() {
        String::new()
    } else {
        format!(": to find out, {}", joined(&recordings, "; and "))
    };
    let names = joined(&names.iter().map(String::as_str).collect::<Vec<&str>>(), " or ");
    format!("These frames cannot tell {names}{remedy}.")
}

fn joined(texts: &[&str], between: &str) -> String {
    texts.join(between)
}

/// "a, b and c".
fn enumerated(texts: &[&str]) -> String {
    match texts {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => texts.concat(),
    }
}

/// With a capital letter and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().map(|letter| letter.to_uppercase().collect()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

/// "photometric", as in "the photometric gap".
fn channel_adjective(channel: &str) -> &str {
    match channel {
        "geometry" => "geometric",
        "photometry" => "photometric",
        "color" => "colour",
        "motion" => "odometry",
        other => other,
    }
}

fn channel_noun(channel: &str) -> &str {
    match channel {
        "geometry" => "the lines' position",
        "photometry" => "brightness",
        "color" => "the colours' offset",
        "noise" => "the noise",
        "motion" => "the odometry",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{
        inference::held_out::ChannelGap,
        report::data::{Estimate, Limit},
    };

    fn gap() -> Gap {
        let channel = |name: &str, [before, after, floor]: [f64; 3], unit: &str| {
            (name.to_owned(), ChannelGap { before, after, floor, unit: unit.to_owned() })
        };
        let channels = BTreeMap::from([
            channel("photometry", [0.3, 0.06, 0.04], "1"),
            channel("geometry", [0.5, 0.42, 0.4], "px"),
        ]);
        Gap { before: 7.0, after: 1.5, floor: 1.0, unit: "noise floors".to_owned(), channels }
    }

    fn found(id: &str, size: &str) -> EffectReport {
        let known = effect(id).unwrap();
        EffectReport {
            id: known.id().to_owned(),
            name: known.name().to_owned(),
            size: size.to_owned(),
            parameters: BTreeMap::new(),
            p_value: 1e-9,
            held_out_gain: Estimate { value: 310.0, sigma: 12.0, unit: None },
            confusable_with: Vec::new(),
            recording_that_would_decide: Vec::new(),
            because: known.because().to_owned(),
            closes: [("geometry", 0.02), ("photometry", 0.93)]
                .map(|(channel, part)| (channel.to_owned(), part))
                .into(),
        }
    }

    fn vignetting() -> EffectReport {
        found("vignetting", "at the corner 42 % of the light is lost (± 1 %)")
    }

    fn pitch() -> EffectReport {
        let closes = BTreeMap::from([("geometry".to_owned(), 0.8)]);
        EffectReport { closes, ..found("mount_pitch", "1.02° too low (± 0.05°)") }
    }

    fn said(verdict: Verdict, effects: &[EffectReport], unexplained: &[Unexplained]) -> String {
        let gap = gap();
        summary(Findings {
            verdict,
            effects,
            in_model: &[],
            given: &Model::default(),
            unexplained,
            gap: &gap,
            not_found: &[],
            unobservable: &[],
        })
    }

    #[test]
    fn one_effect_is_a_sentence() {
        assert_eq!(
            said(Verdict::Named, &[vignetting()], &[]),
            "The lens darkens towards the corners: at the corner 42 % of the light is lost (± 1 %); adding it closes 93 % \
             of the photometric gap."
        );
    }

    #[test]
    fn two_effects_are_added_together() {
        assert_eq!(
            said(Verdict::Named, &[vignetting(), pitch()], &[]),
            "The lens darkens towards the corners: at the corner 42 % of the light is lost (± 1 %). The camera looks lower \
             than the robot believes: 1.02° too low (± 0.05°). Adding both closes 80 % of the geometric gap and 92 % of the \
             photometric gap."
        );
    }

    #[test]
    fn a_rival_makes_it_either_or() {
        let mut pitch = pitch();
        pitch.confusable_with = vec!["principal_point".to_owned()];
        pitch.recording_that_would_decide =
            vec!["look at lines with the head rolled to both sides".to_owned()];
        assert_eq!(
            said(Verdict::Confusable, &[pitch], &[]),
            "Either the camera looks lower than the robot believes (1.02° too low, ± 0.05°) or the optical axis meets the \
             sensor beside the calibrated pixel: these frames cannot tell; to find out, look at lines with the head rolled \
             to both sides; adding the first closes 80 % of the geometric gap."
        );
    }

    #[test]
    fn what_is_unexplained_comes_first() {
        let pattern = Unexplained {
            channel: "sharpness".to_owned(),
            r#where: "in the picture left of the middle, in the lower part".to_owned(),
            size: 0.131,
            unit: "px2".to_owned(),
            p_value: Some(1e-6),
        };
        let sentence = "Something is at work that no effect of the library explains. Sharpness: in the picture left of the \
                        middle, in the lower part (0.13 px²).";
        assert_eq!(said(Verdict::Unknown, &[], std::slice::from_ref(&pattern)), sentence);
        let both = said(Verdict::Unknown, &[vignetting()], &[pattern]);
        assert!(both.starts_with(sentence) && both.contains("The lens darkens"), "{both}");
    }

    #[test]
    fn nothing_missing_says_what_would_have_been_found() {
        let limit = |id: &str, value, unit: &str| {
            let known = effect(id).unwrap();
            NotFoundReport {
                id: known.id().to_owned(),
                name: known.name().to_owned(),
                parameter: known.parameters()[0].name.to_owned(),
                detection_limit: Limit { value, unit: unit.to_owned() },
                p_value: 0.4,
                held_out_gain: Estimate { value: -1.0, sigma: 1.0, unit: None },
            }
        };
        let limits = [
            limit("odometry_scale", 0.03, "1"),
            limit("rolling_shutter", 0.004, "s"),
            limit("mount_pitch", 0.0014, "rad"),
            limit("vignetting", 0.03, "1"),
        ];
        let (gap, given) = (gap(), Model::default());
        let findings = Findings {
            verdict: Verdict::None,
            effects: &[],
            in_model: &[],
            given: &given,
            unexplained: &[],
            gap: &gap,
            not_found: &limits,
            unobservable: &[],
        };
        assert_eq!(
            summary(findings),
            "Nothing is missing: these frames would have shown a loss of light at the corners from 3.0 % on, a mount that \
             looks up or down from 0.080° on and a rolling shutter from 4.0 ms on."
        );
        assert_eq!(
            summary(Findings { not_found: &[], ..findings }),
            "Nothing is missing that these frames would show."
        );
        let blind = |reason: &str| Unobservable {
            id: "black_level".to_owned(),
            name: "black".to_owned(),
            reason: reason.to_owned(),
            recording_that_would_decide: String::new(),
        };
        let unobservable = [blind("it is dark"), blind("it is dark"), blind("nothing moves")];
        let partly = summary(Findings { unobservable: &unobservable, ..findings });
        assert!(
            partly.ends_with("3 of 7 effects cannot be judged, most of them because it is dark."),
            "{partly}"
        );
        let further = summary(Findings { in_model: &[vignetting()], ..findings });
        assert!(
            further.starts_with("Nothing further is missing beside vignetting of the model: "),
            "{further}"
        );
    }

    #[test]
    fn effects_of_the_model_that_do_not_show_or_come_out_otherwise_are_told() {
        let given = Model::default().with(effect("vignetting").unwrap(), [0.42]);
        let told = |strength: f64, p_value: f64| {
            let estimate = Estimate { value: strength, sigma: 0.01, unit: None };
            let parameters = BTreeMap::from([("strength".to_owned(), estimate)]);
            let closes = BTreeMap::new();
            refitted(&EffectReport { parameters, p_value, closes, ..vignetting() }, &given)
        };
        assert_eq!(told(0.43, 1e-9), None);
        assert!(told(0.55, 1e-9).unwrap().contains("another size"));
        assert!(told(0.0, 0.7).unwrap().contains("does not show"));
    }

    #[test]
    fn what_cannot_be_told_comes_with_a_remedy() {
        let shutter = Unobservable {
            id: "rolling_shutter".to_owned(),
            name: "the rows of a picture are exposed one after the other".to_owned(),
            reason: "the camera hardly moves".to_owned(),
            recording_that_would_decide: "walk with quick turns of the head".to_owned(),
        };
        let (gap, given) = (gap(), Model::default());
        let findings = Findings {
            verdict: Verdict::Inconclusive,
            effects: &[],
            in_model: &[],
            given: &given,
            unexplained: &[],
            gap: &gap,
            not_found: &[],
            unobservable: &[shutter],
        };
        assert_eq!(
            summary(findings),
            "These frames cannot tell whether the rows of a picture are exposed one after the other: to find out, walk with \
             quick turns of the head."
        );
        assert!(summary(Findings { unobservable: &[], ..findings }).contains("cannot tell"));
    }
}
