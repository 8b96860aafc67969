//! Verdict in a few sentences.

use reality_sim_core::sequence::counted;
use reality_sim_sensor::{Role, effect, text::percent};

use super::{
    channel::{adjective, noun},
    effect::{deciding_recordings, effect_name, effect_size, library_name, limit},
    finding::{finding_place, finding_size, place_has_size},
    number::closed,
    unobservable::{unobservable_reason, unobservable_remedy},
};
use crate::{
    diagnostics::finding::Finding,
    measurement::quantity::Channel,
    report::data::{EffectReport, Estimate, Gap, NotFoundReport, Report, Unobservable, Verdict},
    thresholds::Thresholds,
};

/// Number of detection limits named if nothing was found.
const LIMITS: usize = 3;
/// Number of unexplained findings, or of unobservable effects, that are named.
const NAMED: usize = 2;

/// Returns the verdict as one to a few sentences.
pub fn summary(report: &Report) -> String {
    if let Some(finding) = report.unexplained.first().filter(|finding| finding.stops_the_analysis()) {
        return sentence(&finding_place(finding));
    }
    let verdict = match report.verdict {
        Verdict::None => nothing(report),
        Verdict::Named | Verdict::Confusable => named(report),
        Verdict::Unknown if report.effects.is_empty() => unknown(&report.unexplained),
        Verdict::Unknown => format!("{} {UNSURE} {}", unknown(&report.unexplained), named(report)),
        Verdict::Inconclusive => inconclusive(&report.unobservable),
    };
    let refitted = report.in_model.iter().filter_map(refitted);
    std::iter::once(verdict).chain(refitted).collect::<Vec<String>>().join(" ")
}

/// Introduction to the effects found if something stays unexplained, which may be part of them.
const UNSURE: &str = "Effects of the library explain a part of it, not for sure while the rest is unknown:";
/// Number of standard deviations from which on a refitted size counts as changed.
const MOVED: f64 = Thresholds::DEFAULT.report.changed_sigmas;
/// P-value below which an effect of the given model counts as visible. It also counts if it closes a part of the gap.
const SHOWS: f64 = Thresholds::DEFAULT.report.shown_p_value;

/// Returns a sentence on an effect of the given model that these frames do not show, or show in another size.
fn refitted(report: &EffectReport) -> Option<String> {
    let known = effect(&report.id)?;
    let (name, size) = (effect_name(report), effect_size(report));
    if report.p_value > SHOWS && report.closes.is_empty() {
        return Some(format!("An effect of the model does not show in these frames, {name}: {size}."));
    }
    let moved = known.parameters().iter().filter(|parameter| parameter.role == Role::Size).any(|parameter| {
        let (was, now) = (report.given.get(parameter.name), report.parameters.get(parameter.name));
        let differs = |(was, now): (&f64, &Estimate)| {
            (now.value - was).abs() > (MOVED * now.sigma).max(parameter.material)
        };
        was.zip(now).is_some_and(differs)
    });
    moved.then(|| format!("An effect of the model has another size than was given, {name}: {size}."))
}

/// Returns a sentence for each effect, and what the effects close.
fn named(report: &Report) -> String {
    let (unsure, sure): (Vec<_>, Vec<_>) =
        report.effects.iter().partition(|effect| !effect.confusable_with.is_empty());
    let mut sentences: Vec<String> =
        sure.iter().map(|effect| format!("{}: {}", effect_name(effect), effect_size(effect))).collect();
    sentences.extend(unsure.into_iter().map(either));
    let one = sentences.len() == 1;
    match (closing(&report.effects, &report.gap), sentences.first_mut()) {
        (Some(closing), Some(only)) if one => only.push_str(&format!("; {closing}")),
        (Some(closing), _) => sentences.push(closing),
        _ => {}
    }
    sentences.iter().map(|text| sentence(text)).collect::<Vec<String>>().join(" ")
}

/// Returns "adding it closes 93 % of the photometric gap", for every channel in which an effect closes most. The fraction is
/// the effect's own if there is one effect, and that of all effects together if there are several.
fn closing(effects: &[EffectReport], gap: &Gap) -> Option<String> {
    let subject = match effects {
        [] => return None,
        [effect] if effect.confusable_with.is_empty() => "it",
        [_] => "the first",
        [_, _] => "both",
        _ => "all of them",
    };
    let mut parts: Vec<(Channel, f64)> =
        effects.iter().filter_map(|effect| most_closed(effect, gap)).collect();
    if effects.len() > 1 {
        for (channel, part) in &mut parts {
            let gap = gap.channels.get(channel)?;
            *part = closed(gap.before, gap.after, gap.floor)?;
        }
    }
    parts.sort_by_key(|part| part.0);
    parts.dedup_by_key(|part| part.0);
    let texts: Vec<String> = parts
        .into_iter()
        .map(|(channel, part)| format!("{} of the {} gap", percent(part), adjective(channel)))
        .collect();
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    (!texts.is_empty()).then(|| format!("adding {subject} closes {}", enumerated(&texts)))
}

/// Returns the channel whose gap, in noise floors, the effect reduces most, with the fraction that it closes.
fn most_closed(effect: &EffectReport, gap: &Gap) -> Option<(Channel, f64)> {
    let distance = |channel: Channel| {
        let gap = gap.channels.get(&channel);
        gap.map_or(0.0, |gap| (gap.before - gap.floor) / gap.floor.max(f64::MIN_POSITIVE))
    };
    let parts = effect.closes.iter().map(|(channel, part)| (*channel, *part));
    parts.max_by(|a, b| (a.1 * distance(a.0)).total_cmp(&(b.1 * distance(b.0))))
}

/// Returns "Either A or B: these frames cannot tell; to find out, …".
fn either(effect: &EffectReport) -> String {
    let others: Vec<&str> = effect.confusable_with.iter().map(|id| library_name(id)).collect();
    let name =
        format!("{} ({})", effect_name(effect), effect_size(effect).replace(" (", ", ").replace(')', ""));
    let recordings = deciding_recordings(effect).join("; or ");
    let remedy = if recordings.is_empty() { String::new() } else { format!("; to find out, {recordings}") };
    format!("either {name} or {}: these frames cannot tell{remedy}", others.join(" or "))
}

/// Returns a sentence for each of the first findings, and the number of further ones.
fn unknown(unexplained: &[Finding]) -> String {
    let mut sentences = vec!["something is at work that no effect of the library explains".to_owned()];
    sentences.extend(unexplained.iter().take(NAMED).map(said));
    match unexplained.len().saturating_sub(NAMED) {
        0 => {}
        1 => sentences.push("there is one more pattern like these".to_owned()),
        more => sentences.push(format!("there are {more} more patterns like these")),
    }
    sentences.iter().map(|text| sentence(text)).collect::<Vec<String>>().join(" ")
}

/// Returns "sharpness: in the picture left of the middle, in the lower part (0.13 px²)", without stating the size twice.
fn said(finding: &Finding) -> String {
    let size = if place_has_size(finding) { String::new() } else { format!(" ({})", finding_size(finding)) };
    format!("{}: {}{size}", noun(finding.channel()), finding_place(finding))
}

/// Returns which effects are not missing, from which sizes on. Effects that cannot be judged are stated first.
fn nothing(report: &Report) -> String {
    let subject = match &report.in_model[..] {
        [] => "Nothing is missing".to_owned(),
        known => {
            let known: Vec<&str> = known.iter().map(|effect| effect.id.as_str()).collect();
            format!("Nothing further is missing beside {} of the model", enumerated(&known))
        }
    };
    match (not_judged(report), shown_from(&report.not_found)) {
        (None, None) => format!("{subject} that these frames would show."),
        (None, Some(limits)) => format!("{subject}: these frames would have shown {limits}."),
        (Some(others), None) => format!("{subject} among what can be judged; {others}."),
        (Some(others), Some(limits)) => {
            format!("{subject} among what can be judged; {others}. These frames would have shown {limits}.")
        }
    }
}

/// Returns "9 of 22 effects could not be judged: …, most of them because …".
fn not_judged(report: &Report) -> Option<String> {
    let causes = || {
        let missing = report.unobservable.iter().filter(|effect| !effect.cause.is_lack_of_movement());
        missing.map(|effect| &effect.cause)
    };
    let ids: Vec<&str> = report.not_judged().collect();
    let known = [report.effects.len(), report.in_model.len(), report.not_found.len()];
    let all = report.unobservable.len() + known.iter().sum::<usize>();
    let times = |cause| causes().filter(|other| *other == cause).count();
    let usual = causes().max_by_key(|cause| times(*cause))?;
    let most = if times(usual) < ids.len() { ", most of them" } else { "" };
    Some(format!(
        "{} of {all} effects could not be judged: {}{most} because {}",
        ids.len(),
        enumerated(&ids),
        unobservable_reason(usual)
    ))
}

/// Returns "a loss of light at the corners from 3.0 % on and …".
fn shown_from(not_found: &[NotFoundReport]) -> Option<String> {
    let mut limits: Vec<(u32, String)> = not_found
        .iter()
        .filter(|report| report.detection_limit.value.is_finite())
        .filter_map(|report| {
            let about = effect(&report.id)?.about();
            Some((about.rank, format!("{} from {} on", about.noun, limit(report))))
        })
        .collect();
    limits.sort();
    limits.truncate(LIMITS);
    let limits: Vec<&str> = limits.iter().map(|(_, text)| text.as_str()).collect();
    (!limits.is_empty()).then(|| enumerated(&limits))
}

/// Returns which effects these frames cannot show, and what to record to see them.
fn inconclusive(unobservable: &[Unobservable]) -> String {
    let first = || unobservable.iter().take(NAMED);
    let names: Vec<String> = first().map(|effect| format!("whether {}", library_name(&effect.id))).collect();
    let others: Vec<&str> = unobservable.iter().skip(NAMED).map(|effect| effect.id.as_str()).collect();
    let mut recordings: Vec<&str> = first().map(unobservable_remedy).collect();
    recordings.retain(|recording| !recording.is_empty());
    recordings.dedup();
    if names.is_empty() {
        return "These frames cannot tell whether anything is missing.".to_owned();
    }
    let remedy = if recordings.is_empty() {
        String::new()
    } else {
        format!(": to find out, {}", recordings.join("; and "))
    };
    let others = match others.len() {
        0 => String::new(),
        count => {
            format!(". {} could not be judged either: {}", counted(count, "more effect"), enumerated(&others))
        }
    };
    format!("These frames cannot tell {}{remedy}{others}.", names.join(" or "))
}

/// Returns "a, b and c".
fn enumerated(texts: &[&str]) -> String {
    match texts {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => texts.concat(),
    }
}

/// Returns a text with a capital letter and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().map(|letter| letter.to_uppercase().collect()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

#[cfg(test)]
mod tests {
    use reality_sim_sensor::EffectIndex;

    use super::*;
    use crate::{
        diagnostics::finding::PatternCell,
        inference::{
            detection_limit::{MissingInput, UnobservableCause},
            held_out::ChannelGap,
        },
        report::data::Limit,
        testing::{effect_report, report},
    };

    /// Returns a report with these effects and findings.
    fn of(verdict: Verdict, effects: &[EffectReport], unexplained: &[Finding]) -> Report {
        let channels = [
            (Channel::Photometry, ChannelGap { before: 0.3, after: 0.06, floor: 0.04, left_out: 0.1 }),
            (Channel::Geometry, ChannelGap { before: 0.5, after: 0.42, floor: 0.4, left_out: 0.1 }),
        ];
        let gap = Gap { before: 7.0, after: 1.5, floor: 1.0, channels: channels.into() };
        Report { verdict, effects: effects.to_vec(), unexplained: unexplained.to_vec(), gap, ..report() }
    }

    fn estimated(id: &str, parameter: &str, value: f64, sigma: f64) -> EffectReport {
        let mut effect = effect_report(id, 0.0);
        let estimate = effect.parameters.get_mut(parameter).unwrap();
        (estimate.value, estimate.sigma) = (value, sigma);
        effect.closes = [(Channel::Geometry, 0.02), (Channel::Photometry, 0.93)].into();
        effect
    }

    fn vignetting() -> EffectReport {
        estimated("vignetting", "strength", 0.421, 0.0051)
    }

    fn pitch() -> EffectReport {
        let degree = 1f64.to_radians();
        let pitch = estimated("mount_pitch", "pitch_rad", 1.02 * degree, 0.0255 * degree);
        EffectReport { closes: [(Channel::Geometry, 0.8)].into(), ..pitch }
    }

    #[test]
    fn one_effect_is_a_sentence() {
        assert_eq!(
            summary(&of(Verdict::Named, &[vignetting()], &[])),
            "The lens darkens towards the corners: at the corner 42 % of the light is lost (± 1 %); adding it closes 93 % \
             of the photometric gap."
        );
    }

    #[test]
    fn two_effects_are_added_together() {
        assert_eq!(
            summary(&of(Verdict::Named, &[vignetting(), pitch()], &[])),
            "The lens darkens towards the corners: at the corner 42 % of the light is lost (± 1 %). The camera looks lower \
             than the robot believes: 1.02° too low (± 0.05°). Adding both closes 80 % of the geometric gap and 92 % of the \
             photometric gap."
        );
    }

    #[test]
    fn confusable_effects_are_stated_as_alternatives() {
        let pitch = EffectReport { confusable_with: vec!["principal_point".to_owned()], ..pitch() };
        let remedy = effect("principal_point").unwrap().recording_that_would_decide();
        assert_eq!(
            summary(&of(Verdict::Confusable, &[pitch], &[])),
            format!(
                "Either the camera looks lower than the robot believes (1.02° too low, ± 0.05°) or the optical axis meets \
                 the sensor beside the calibrated pixel: these frames cannot tell; to find out, {remedy}; adding the first \
                 closes 80 % of the geometric gap."
            )
        );
    }

    #[test]
    fn unexplained_findings_come_first() {
        let strongest = PatternCell::Picture { column: 2, row: 4, grid: [8, 6] };
        let pattern = Finding::Pattern { channel: Channel::Sharpness, strongest, size: 0.131, p_value: 1e-6 };
        let sentence = "Something is at work that no effect of the library explains. Sharpness: in the picture, strongest \
                        left of the middle, in the lower part (0.13 px²).";
        assert_eq!(summary(&of(Verdict::Unknown, &[], &[pattern])), sentence);
        let both = summary(&of(Verdict::Unknown, &[vignetting()], &[pattern]));
        assert!(both.starts_with(sentence) && both.contains("The lens darkens"), "{both}");
    }

    #[test]
    fn a_size_in_the_words_for_the_place_is_not_repeated_and_further_findings_are_counted() {
        let hidden = Finding::Obstruction { share: 0.124, column: 0, row: 4, grid: [8, 6] };
        let text = summary(&of(Verdict::Unknown, &[], &[hidden; 4]));
        assert!(text.contains("wherever the camera looks. "), "{text}");
        assert!(text.ends_with("There are 2 more patterns like these."), "{text}");
    }

    #[test]
    fn a_summary_without_effects_states_what_would_have_been_found() {
        let limit = |id: &str, value, unit: &str| NotFoundReport {
            id: id.to_owned(),
            parameter: effect(id).unwrap().parameters()[0].name.to_owned(),
            detection_limit: Limit { value, unit: unit.to_owned() },
            p_value: 0.4,
            held_out_gain: Estimate { value: -1.0, sigma: 1.0, unit: None, at_range_end: false },
        };
        let not_found = vec![
            limit("odometry_scale", 0.03, "1"),
            limit("rolling_shutter", 0.004, "s"),
            limit("mount_pitch", 0.0014, "rad"),
            limit("vignetting", 0.03, "1"),
        ];
        let nothing = of(Verdict::None, &[], &[]);
        assert_eq!(summary(&nothing), "Nothing is missing that these frames would show.");
        let limited = Report { not_found, ..nothing };
        assert_eq!(
            summary(&limited),
            "Nothing is missing: these frames would have shown a loss of light at the corners from 3.0 % on, a mount that \
             looks up or down from 0.080° on and a rolling shutter from 4.0 ms on."
        );
        let further = summary(&Report { in_model: vec![vignetting()], ..limited.clone() });
        assert!(
            further.starts_with("Nothing further is missing beside vignetting of the model: "),
            "{further}"
        );
        let unseen = |id: &str, input| Unobservable {
            id: id.to_owned(),
            cause: UnobservableCause::MissingInput { input },
        };
        let unobservable = vec![
            unseen("black_level", MissingInput::Reflectance),
            unseen("tone_curve", MissingInput::Reflectance),
            unseen("defocus", MissingInput::Sharpness),
        ];
        let partly = summary(&Report { unobservable, ..limited });
        assert!(
            partly.starts_with(
                "Nothing is missing among what can be judged; 3 of 7 effects could not be judged: black_level, tone_curve \
                 and defocus, most of them because nothing in camera.toml says how bright lines and carpet are. These frames \
                 would have shown a loss of light"
            ),
            "{partly}"
        );
    }

    #[test]
    fn effects_of_the_model_that_do_not_show_or_have_another_size_are_mentioned() {
        let told = |strength: f64, p_value: f64| {
            let given = [("strength".to_owned(), 0.42)].into();
            let effect = estimated("vignetting", "strength", strength, 0.01);
            refitted(&EffectReport { given, p_value, closes: Default::default(), ..effect })
        };
        assert_eq!(told(0.43, 1e-9), None);
        assert!(told(0.55, 1e-9).unwrap().contains("another size"));
        assert!(told(0.0, 0.7).unwrap().contains("does not show"));
    }

    #[test]
    fn effects_that_cannot_be_seen_are_stated_with_a_remedy() {
        let shutter =
            Unobservable { id: "rolling_shutter".to_owned(), cause: UnobservableCause::CameraAtRest };
        let inconclusive = of(Verdict::Inconclusive, &[], &[]);
        assert_eq!(summary(&inconclusive), "These frames cannot tell whether anything is missing.");
        let known = effect("rolling_shutter").unwrap();
        let (name, remedy) = (known.name(), known.recording_that_would_decide());
        assert_eq!(
            summary(&Report { unobservable: vec![shutter], ..inconclusive }),
            format!("These frames cannot tell whether {name}: to find out, {remedy}.")
        );
    }

    #[test]
    fn all_effects_that_cannot_be_seen_are_named() {
        let effects: Vec<_> = EffectIndex::all().take(9).map(EffectIndex::effect).collect();
        let cause = UnobservableCause::CameraAtRest;
        let unobservable =
            effects.iter().map(|known| Unobservable { id: known.id().to_owned(), cause }).collect();
        let said = summary(&Report { unobservable, ..of(Verdict::Inconclusive, &[], &[]) });
        for (index, known) in effects.iter().enumerate() {
            let name = if index < NAMED { known.name() } else { known.id() };
            assert!(said.contains(name), "{name}: {said}");
        }
    }
}
