//! `report.json`: the numbers of a report, together with the words that [`super::text`] makes from them.
//!
//! The words are only written: a report that is read makes them again from its numbers.

use std::collections::BTreeMap;

use reality_sim_core::field::FieldDimensions;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    diagnostics::finding::Finding,
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
    gap: WrittenGap<'a>,
    not_found: Vec<WrittenNotFound<'a>>,
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
            gap: WrittenGap::from(&report.gap),
            not_found: report.not_found.iter().map(WrittenNotFound::from).collect(),
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
mod tests {
    use std::fs;

    use reality_sim_sensor::library;

    use super::*;
    use crate::{
        diagnostics::{
            finding::{FieldLine, Movement, NominalValue, OdometryComponent, PatternCell},
            input_mistake::InputMistake,
        },
        inference::detection_limit::MissingInput,
        measurement::quantity::ColorChannel,
        report::file::{ReportError, ReportFault},
        testing::{self, effect_report},
    };

    /// Returns one finding of every kind.
    fn all_findings() -> Vec<Finding> {
        let cells = [
            PatternCell::Picture { column: 2, row: 4, grid: [8, 6] },
            PatternCell::Field { x_m: 1.5, y_m: -0.5 },
            PatternCell::Time { after_s: 3.0 },
            PatternCell::Speed { widths_per_s: 0.25 },
        ];
        let lines = [
            FieldLine::Segment { from_m: [-4.5, 3.0], to_m: [4.5, 3.0] },
            FieldLine::Circle { diameter_m: 1.5 },
        ];
        let values = [
            NominalValue::LineLevel(ColorChannel::Red),
            NominalValue::CarpetLevel(ColorChannel::Blue),
            NominalValue::Sheen,
            NominalValue::Blur,
            NominalValue::BlurByWidth,
            NominalValue::BlurShape,
            NominalValue::NoiseVariance,
        ];
        let pattern = |strongest| Finding::Pattern {
            channel: Channel::Sharpness,
            strongest,
            size: 0.3,
            p_value: 3.25e-8,
        };
        let missing = |line| Finding::MissingLine { line, found_share: 0.143, usual_share: 0.9 };
        let nominal = |value| Finding::NominalValue { value, off_by: 0.3, p_value: 1e-3 };
        let odometry = |component, follows| Finding::Odometry { component, follows, size: 0.012 };
        let mut all = vec![
            Finding::InputMistake { mistake: InputMistake::PosesCameraFromWorld },
            Finding::InputMistake { mistake: InputMistake::FieldOfAnotherLeague(2) },
            Finding::Flicker { size: 0.07, p_value: 1e-4 },
            Finding::Occluders { share: 0.12 },
            Finding::DynamicObjects { share: 0.5 },
            odometry(OdometryComponent::Forward, Movement::Ahead),
            odometry(OdometryComponent::Left, Movement::Turn),
            odometry(OdometryComponent::Turn, Movement::Time),
            Finding::Scatter { channel: Channel::Geometry, size: 1.4, floor: 0.5 },
        ];
        all.extend(cells.map(pattern));
        all.extend(lines.map(missing));
        all.extend(values.map(nominal));
        all
    }

    fn all_causes() -> [UnobservableCause; 9] {
        let missing = |input| UnobservableCause::MissingInput { input };
        [
            missing(MissingInput::Odometry),
            missing(MissingInput::MeasuredPoses),
            missing(MissingInput::Reflectance),
            missing(MissingInput::Noise),
            missing(MissingInput::Sharpness),
            UnobservableCause::CameraAtRest,
            UnobservableCause::RobotAtRest,
            UnobservableCause::FewViews { views: 3, needed: 8 },
            UnobservableCause::NotSeparable,
        ]
    }

    /// Returns a report in which no part is empty.
    fn full() -> Report {
        let map = |value: f64| Map {
            columns: 2,
            rows: 1,
            extent: [0.0, 0.0, 2.0, 1.0],
            before: vec![Some(value), None],
            after: vec![None, Some(-value)],
        };
        let time = Course {
            time_s: vec![0.1, 0.3],
            held_out: vec![false, true],
            before: vec![Some(0.333), None],
            after: vec![None; 2],
        };
        let maps = Maps { picture: map(0.1), field: map(0.333), time };
        let mut noise = effect_report("sensor_noise", 0.001);
        noise.correlations.entry("shot".to_owned()).or_default().insert("read_variance".to_owned(), -0.375);
        noise.confusable_with = vec!["vignetting".to_owned()];
        noise.closes = [(Channel::Noise, 0.9)].into();
        let mut pitch = effect_report("mount_pitch", -0.02);
        pitch.given = [("pitch_rad".to_owned(), -0.0143)].into();
        let channels =
            Channel::ALL.map(|channel| (channel, ChannelGap { before: 0.143, after: 0.06, floor: 0.04 }));
        let not_found = NotFoundReport {
            id: "rolling_shutter".to_owned(),
            parameter: "readout_s".to_owned(),
            detection_limit: Limit { value: 0.007, unit: "s".to_owned() },
            p_value: 0.4,
            held_out_gain: Estimate { value: -0.375, sigma: 1.0, unit: None },
        };
        let unseen = |cause| Unobservable { id: "time_offset".to_owned(), cause };
        Report {
            verdict: Verdict::Unknown,
            effects: vec![noise],
            in_model: vec![pitch],
            unexplained: all_findings(),
            gap: Gap { before: 2.33, after: 1.5, floor: 1.0, channels: channels.into() },
            not_found: vec![not_found],
            unobservable: all_causes().map(unseen).to_vec(),
            maps: Channel::ALL.map(|channel| (channel, maps.clone())).into(),
            left_out: vec!["images/7.png".to_owned()],
            poses: PosesReport { source: ReferenceSource::Tagged, ..testing::report().poses },
            ..testing::report()
        }
    }

    /// Writes a report's file into a folder of its own and reads it.
    fn read_again(name: &str, file: &str) -> Result<Report, ReportError> {
        let folder = std::env::temp_dir().join(format!("reality-sim-report-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("report.json"), file).unwrap();
        let report = Report::read(&folder);
        fs::remove_dir_all(&folder).unwrap();
        report
    }

    #[test]
    fn a_report_that_is_written_and_read_again_is_the_same() {
        for report in [full(), testing::report()] {
            let file = serde_json::to_string_pretty(&report).unwrap();
            assert_eq!(read_again("same", &file).unwrap(), report);
        }
    }

    #[test]
    fn a_report_of_another_version_is_refused_as_such_and_other_files_are_no_reports() {
        let with_version = |version: Option<u32>| {
            let mut written = serde_json::to_value(full()).unwrap();
            let fields = written.as_object_mut().unwrap();
            match version {
                Some(version) => fields.insert("version".to_owned(), version.into()),
                None => fields.remove("version"),
            };
            written.to_string()
        };
        assert!(read_again("version", &with_version(Some(VERSION))).is_ok());
        for other in [None, Some(VERSION + 1)] {
            let error = read_again("version", &with_version(other)).unwrap_err();
            assert!(matches!(error.fault, ReportFault::Version { found } if found == other), "{error}");
        }
        for file in ["{}", "[]", "{\"version\": \"first\"}", "{\"version\": 1}", "{\"version\": 1"] {
            let error = read_again("version", file).unwrap_err();
            assert!(matches!(error.fault, ReportFault::Malformed(_)), "{file}: {error}");
        }
    }

    #[test]
    fn words_stand_beside_the_numbers() {
        let written = serde_json::to_value(full()).unwrap();
        let texts = [
            "/summary",
            "/effects/0/name",
            "/effects/0/size",
            "/effects/0/because",
            "/effects/0/recording_that_would_decide/0",
            "/unexplained/0/where",
            "/unobservable/0/reason",
            "/unobservable/0/recording_that_would_decide",
            "/not_found/0/name",
            "/poses/absorbed",
        ];
        for place in texts {
            let text = written.pointer(place).and_then(|value| value.as_str());
            assert!(text.is_some_and(|text| !text.is_empty()), "{place}");
        }
        assert_eq!(written["unexplained"][0]["finding"]["kind"], "flicker");
        assert_eq!(written["unobservable"][6]["cause"]["kind"], "few_views");
        assert_eq!(written["gap"]["channels"]["geometry"]["unit"], "px");
        assert_eq!(written["maps"]["sharpness"]["unit"], "px2");
    }

    #[test]
    fn a_reader_ignores_the_words() {
        let report = full();
        let mut written = serde_json::to_value(&report).unwrap();
        written["summary"] = "Something else.".into();
        written["unexplained"][0]["where"] = "elsewhere".into();
        written["unobservable"][0]["reason"] = "because".into();
        assert_eq!(serde_json::from_value::<Report>(written).unwrap(), report);
    }

    #[test]
    fn every_effect_can_be_written_with_any_sizes() {
        for effect in library() {
            for value in [-0.01, 0.0, 0.01] {
                let report = Report { effects: vec![effect_report(effect.id(), value)], ..full() };
                assert!(serde_json::to_string(&report).is_ok(), "{}", effect.id());
            }
        }
    }
}
