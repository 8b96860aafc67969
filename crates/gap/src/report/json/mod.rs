//! `report.json`: the numbers of a report, together with the words that [`super::text`] makes from them.
//!
//! The words are only written: a report that is read makes them again from its numbers.

use std::collections::BTreeMap;

use reality_sim_core::field::FieldDimensions;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    diagnostics::{finding::Finding, object::Object},
    inference::{detection_limit::UnobservableCause, held_out::ChannelGap},
    measurement::quantity::Channel,
    recording::ReferenceSource,
    report::{
        data::{
            Course, EffectReport, Estimate, Gap, Limit, Map, Maps, NotFoundReport, PosesReport, Report,
            Unobservable, VERSION, Verdict,
        },
        text,
    },
};

/// Values by the channels' names, in alphabetical order.
type ByChannel<T> = BTreeMap<&'static str, T>;

#[derive(Serialize)]
struct Written<'a> {
    version: u32,
    recording: &'a str,
    frames: usize,
    held_out_frames: usize,
    left_out: &'a [String],
    verdict: Verdict,
    summary: String,
    effects: Vec<WrittenEffect<'a>>,
    in_model: Vec<WrittenEffect<'a>>,
    unexplained: Vec<WrittenFinding<'a>>,
    objects: Vec<WrittenObject<'a>>,
    gap: WrittenGap<'a>,
    not_found: Vec<WrittenNotFound<'a>>,
    not_judged: Vec<&'a str>,
    unobservable: Vec<WrittenUnobservable<'a>>,
    poses: WrittenPoses,
    maps: ByChannel<WrittenMaps<'a>>,
    shown_frame: usize,
    seed: u64,
    field: &'a FieldDimensions,
}

#[derive(Serialize)]
struct WrittenEffect<'a> {
    id: &'a str,
    name: &'a str,
    size: String,
    parameters: &'a BTreeMap<String, Estimate>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    correlations: &'a BTreeMap<String, BTreeMap<String, f64>>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    given: &'a BTreeMap<String, f64>,
    p_value: f64,
    held_out_gain: &'a Estimate,
    confusable_with: &'a [String],
    recording_that_would_decide: Vec<&'static str>,
    because: &'static str,
    closes: ByChannel<f64>,
}

#[derive(Serialize)]
struct WrittenFinding<'a> {
    channel: &'static str,
    r#where: String,
    size: f64,
    unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    p_value: Option<f64>,
    finding: &'a Finding,
}

#[derive(Serialize)]
struct WrittenObject<'a> {
    r#where: String,
    #[serde(flatten)]
    object: &'a Object,
}

#[derive(Serialize)]
struct WrittenGap<'a> {
    before: f64,
    after: f64,
    floor: f64,
    unit: &'static str,
    channels: ByChannel<WrittenChannelGap<'a>>,
}

#[derive(Serialize)]
struct WrittenChannelGap<'a> {
    #[serde(flatten)]
    gap: &'a ChannelGap,
    unit: &'static str,
}

#[derive(Serialize)]
struct WrittenNotFound<'a> {
    id: &'a str,
    name: &'a str,
    parameter: &'a str,
    detection_limit: &'a Limit,
    p_value: f64,
    held_out_gain: &'a Estimate,
}

#[derive(Serialize)]
struct WrittenUnobservable<'a> {
    id: &'a str,
    name: &'a str,
    reason: &'static str,
    recording_that_would_decide: &'static str,
    cause: &'a UnobservableCause,
}

#[derive(Serialize)]
struct WrittenPoses {
    source: ReferenceSource,
    rotation_sigma_rad: [f64; 3],
    position_sigma_m: [f64; 3],
    absorbed: &'static str,
}

#[derive(Serialize)]
struct WrittenMaps<'a> {
    unit: &'static str,
    picture: &'a Map,
    field: &'a Map,
    time: &'a Course,
}

impl Serialize for Report {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Written::from(self).serialize(serializer)
    }
}

impl<'a> From<&'a Report> for Written<'a> {
    fn from(report: &'a Report) -> Self {
        Self {
            version: VERSION,
            recording: &report.recording,
            frames: report.frames,
            held_out_frames: report.held_out_frames,
            left_out: &report.left_out,
            verdict: report.verdict,
            summary: text::summary(report),
            effects: report.effects.iter().map(WrittenEffect::from).collect(),
            in_model: report.in_model.iter().map(WrittenEffect::from).collect(),
            unexplained: report.unexplained.iter().map(WrittenFinding::from).collect(),
            objects: report.objects.iter().map(WrittenObject::from).collect(),
            gap: WrittenGap::from(&report.gap),
            not_found: report.not_found.iter().map(WrittenNotFound::from).collect(),
            not_judged: report.not_judged().collect(),
            unobservable: report.unobservable.iter().map(WrittenUnobservable::from).collect(),
            poses: WrittenPoses::from(&report.poses),
            maps: by_channel(&report.maps, WrittenMaps::new),
            shown_frame: report.shown_frame,
            seed: report.seed,
            field: &report.field,
        }
    }
}

fn by_channel<'a, T, W>(
    values: &'a BTreeMap<Channel, T>,
    written: impl Fn(Channel, &'a T) -> W,
) -> ByChannel<W> {
    values.iter().map(|(channel, value)| (channel.name(), written(*channel, value))).collect()
}

impl<'a> From<&'a EffectReport> for WrittenEffect<'a> {
    fn from(effect: &'a EffectReport) -> Self {
        Self {
            id: &effect.id,
            name: text::effect_name(effect),
            size: text::effect_size(effect),
            parameters: &effect.parameters,
            correlations: &effect.correlations,
            given: &effect.given,
            p_value: effect.p_value,
            held_out_gain: &effect.held_out_gain,
            confusable_with: &effect.confusable_with,
            recording_that_would_decide: text::deciding_recordings(effect),
            because: text::effect_because(effect),
            closes: by_channel(&effect.closes, |_, part| *part),
        }
    }
}

impl<'a> From<&'a Finding> for WrittenFinding<'a> {
    fn from(finding: &'a Finding) -> Self {
        Self {
            channel: finding.channel().name(),
            r#where: text::finding_place(finding),
            size: finding.size(),
            unit: finding.unit(),
            p_value: finding.p_value(),
            finding,
        }
    }
}

impl<'a> From<&'a Object> for WrittenObject<'a> {
    fn from(object: &'a Object) -> Self {
        Self { r#where: text::object_place(object), object }
    }
}

impl<'a> From<&'a Gap> for WrittenGap<'a> {
    fn from(gap: &'a Gap) -> Self {
        let channel = |channel: Channel, gap| WrittenChannelGap { gap, unit: channel.unit() };
        Self {
            before: gap.before,
            after: gap.after,
            floor: gap.floor,
            unit: text::GAP_UNIT,
            channels: by_channel(&gap.channels, channel),
        }
    }
}

impl<'a> From<&'a NotFoundReport> for WrittenNotFound<'a> {
    fn from(effect: &'a NotFoundReport) -> Self {
        Self {
            id: &effect.id,
            name: text::library_name(&effect.id),
            parameter: &effect.parameter,
            detection_limit: &effect.detection_limit,
            p_value: effect.p_value,
            held_out_gain: &effect.held_out_gain,
        }
    }
}

impl<'a> From<&'a Unobservable> for WrittenUnobservable<'a> {
    fn from(effect: &'a Unobservable) -> Self {
        Self {
            id: &effect.id,
            name: text::library_name(&effect.id),
            reason: text::unobservable_reason(&effect.cause),
            recording_that_would_decide: text::unobservable_remedy(effect),
            cause: &effect.cause,
        }
    }
}

impl From<&PosesReport> for WrittenPoses {
    fn from(poses: &PosesReport) -> Self {
        Self {
            source: poses.source,
            rotation_sigma_rad: poses.rotation_sigma_rad,
            position_sigma_m: poses.position_sigma_m,
            absorbed: text::absorbed(poses.source),
        }
    }
}

impl<'a> WrittenMaps<'a> {
    fn new(channel: Channel, maps: &'a Maps) -> Self {
        Self { unit: channel.unit(), picture: &maps.picture, field: &maps.field, time: &maps.time }
    }
}

/// Deserializes findings, which stand beside their words.
pub(super) fn findings<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Finding>, D::Error> {
    #[derive(Deserialize)]
    struct Entry {
        finding: Finding,
    }
    let entries = Vec::<Entry>::deserialize(deserializer)?;
    Ok(entries.into_iter().map(|entry| entry.finding).collect())
}

#[cfg(test)]
mod tests;
