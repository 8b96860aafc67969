use std::fs;

use image::{GrayImage, RgbImage};
use proptest::prelude::*;
use reality_sim_sensor::library;

use super::*;
use crate::{
    diagnostics::{
        finding::{FieldLine, Movement, NominalValue, OdometryComponent, PatternCell},
        input_mistake::InputMistake,
        object::ObjectMotion,
    },
    inference::detection_limit::MissingInput,
    measurement::quantity::ColorChannel,
    report::{
        file::{ReportError, ReportFault},
        html::page,
        pictures::Pictures,
    },
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
    let lines =
        [FieldLine::Segment { from_m: [-4.5, 3.0], to_m: [4.5, 3.0] }, FieldLine::Circle { diameter_m: 1.5 }];
    let values = [
        NominalValue::LineLevel(ColorChannel::Red),
        NominalValue::CarpetLevel(ColorChannel::Blue),
        NominalValue::Blur,
        NominalValue::BlurByWidth,
        NominalValue::BlurShape,
        NominalValue::NoiseVariance,
    ];
    let pattern =
        |strongest| Finding::Pattern { channel: Channel::Sharpness, strongest, size: 0.3, p_value: 3.25e-8 };
    let missing = |line| Finding::MissingLine { line, found_share: 0.143, usual_share: 0.9 };
    let nominal = |value| Finding::NominalValue { value, off_by: 0.3, p_value: 1e-3 };
    let odometry = |component, follows| Finding::Odometry { component, follows, size: 0.012 };
    let mut all = vec![
        Finding::Flicker { size: 0.07, p_value: 1e-4 },
        odometry(OdometryComponent::Forward, Movement::Ahead),
        odometry(OdometryComponent::Left, Movement::Turn),
        odometry(OdometryComponent::Turn, Movement::Time),
        Finding::UnexplainedLines { share: 0.39 },
        Finding::Scatter { channel: Channel::Geometry, size: 1.4, floor: 0.5 },
        Finding::InputMistake { mistake: InputMistake::PosesCameraFromWorld },
        Finding::InputMistake { mistake: InputMistake::FieldOfAnotherLeague(2) },
    ];
    all.extend(cells.map(pattern));
    all.push(Finding::Obstruction { share: 0.12, column: 1, row: 4, grid: [8, 6] });
    all.extend(lines.map(missing));
    all.extend(values.map(nominal));
    all
}

fn all_objects() -> Vec<Object> {
    let standing =
        Object { motion: ObjectMotion::Standing, share: 0.031, pictures: 0.4, place_m: Some([1.25, -0.5]) };
    vec![standing, Object { motion: ObjectMotion::Moving, place_m: None, ..standing }]
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
    let channels = Channel::ALL
        .map(|channel| (channel, ChannelGap { before: 0.143, after: 0.06, floor: 0.04, left_out: 0.1 }));
    let not_found = NotFoundReport {
        id: "rolling_shutter".to_owned(),
        parameter: "readout_s".to_owned(),
        detection_limit: Limit { value: 0.007, unit: "s".to_owned() },
        p_value: 0.4,
        held_out_gain: Estimate { value: -0.375, sigma: 1.0, unit: None, at_range_end: false },
    };
    let unseen = |cause| Unobservable { id: "time_offset".to_owned(), cause };
    Report {
        verdict: Verdict::Unknown,
        effects: vec![noise],
        in_model: vec![pitch],
        unexplained: all_findings(),
        objects: all_objects(),
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
    let [empty, cut] = ["}", ""].map(|end| format!("{{\"version\": {VERSION}{end}"));
    for file in ["{}", "[]", "{\"version\": \"first\"}", &empty, &cut] {
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
        "/objects/1/where",
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
    assert_eq!(written["objects"][0]["motion"], "standing");
    assert_eq!(written["not_judged"], serde_json::json!(vec!["time_offset"; 6]));
    assert_eq!(written["unobservable"][7]["cause"]["kind"], "few_views");
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

/// What may stand in the place of a value.
fn hostile_value() -> impl Strategy<Value = serde_json::Value> {
    use serde_json::json;
    prop::sample::select(vec![
        json!(null),
        json!(-1),
        json!(1e308),
        json!(u64::MAX),
        json!(""),
        json!("<script>\u{0}\u{1b}[2J\n"),
        json!([]),
        json!({}),
        json!([[[]]]),
    ])
}

/// Puts a value in the place of the one that is reached by these choices, from the outermost object inwards.
fn replace_within(value: &mut serde_json::Value, choices: &[prop::sample::Index], new: serde_json::Value) {
    let Some((choice, rest)) = choices.split_first() else { return *value = new };
    match value {
        serde_json::Value::Object(fields) if !fields.is_empty() => {
            let place = choice.index(fields.len());
            fields
                .values_mut()
                .nth(place)
                .into_iter()
                .for_each(|inner| replace_within(inner, rest, new.clone()));
        }
        serde_json::Value::Array(values) if !values.is_empty() => {
            let place = choice.index(values.len());
            replace_within(&mut values[place], rest, new);
        }
        value => *value = new,
    }
}

proptest! {
    #[test]
    fn a_hostile_report_is_read_or_refused_on_one_line(
        choices in prop::collection::vec(any::<prop::sample::Index>(), 1..7),
        new in hostile_value(),
        end in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut written = serde_json::to_value(full()).unwrap();
        replace_within(&mut written, &choices, new);
        let mut file = serde_json::to_string_pretty(&written).unwrap();
        if let Some(end) = end {
            file.truncate((0..=end.index(file.len())).rev().find(|at| file.is_char_boundary(*at)).unwrap_or(0));
        }
        match read_again("hostile", &file) {
            // Whatever can be read can be shown, and keeps what it holds.
            Ok(report) => {
                let none = || RgbImage::new(0, 0);
                let field = GrayImage::new(0, 0);
                let page = page(&report, &Pictures { measured: none(), before: none(), after: none(), field });
                prop_assert!(!page.contains(|letter: char| letter.is_control() && letter != '\n'));
                prop_assert!(!page.contains("<script>"));
            }
            Err(error) => {
                let message = error.to_string();
                prop_assert!(!message.contains(char::is_control) && !message.is_empty(), "{:?}", message);
            }
        }
    }
}
