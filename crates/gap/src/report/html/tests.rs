use std::collections::BTreeMap;

use image::{GrayImage, Luma, Rgb, RgbImage};
use reality_sim_core::field::FieldDimensions;
use reality_sim_sensor::{Effect, Parameter, library};

use super::*;
use crate::{
    recording::ReferenceSource,
    report::data::{
        Course, EffectReport, Estimate, Gap, Limit, Map, NotFoundReport, PosesReport, Unexplained,
        Unobservable,
    },
};

const HOSTILE: &str = "<script>alert(\"walk\")</script> & 'more'";

fn by_channel<T, const N: usize>(values: [(&str, T); N]) -> BTreeMap<String, T> {
    values.map(|(channel, value)| (channel.to_owned(), value)).into()
}

fn channel([before, after, floor]: [f64; 3], unit: &str) -> ChannelGap {
    ChannelGap { before, after, floor, unit: unit.to_owned() }
}

fn found(effect: &dyn Effect) -> EffectReport {
    let estimate = |parameter: &Parameter| {
        (
            parameter.name.to_owned(),
            Estimate { value: 0.421, sigma: 0.0051, unit: Some(parameter.unit.to_owned()) },
        )
    };
    EffectReport {
        id: effect.id().to_owned(),
        name: effect.name().to_owned(),
        size: "at the corner 42 % of the light is lost (± 1 %)".to_owned(),
        parameters: effect.parameters().iter().map(estimate).collect(),
        p_value: 1.3e-41,
        held_out_gain: Estimate { value: 310.2, sigma: 12.3, unit: None },
        confusable_with: vec!["uneven_illumination".to_owned()],
        recording_that_would_decide: vec![effect.recording_that_would_decide().to_owned()],
        because: effect.because().to_owned(),
        closes: by_channel([("photometry", 0.93)]),
    }
}

fn not_found(effect: &dyn Effect) -> NotFoundReport {
    let parameter = effect.parameters()[0];
    NotFoundReport {
        id: effect.id().to_owned(),
        name: effect.name().to_owned(),
        parameter: parameter.name.to_owned(),
        detection_limit: Limit { value: 2.0 * parameter.material, unit: parameter.unit.to_owned() },
        p_value: 0.4,
        held_out_gain: Estimate { value: -1.2, sigma: 0.8, unit: None },
    }
}

fn unobservable(effect: &dyn Effect) -> Unobservable {
    Unobservable {
        id: effect.id().to_owned(),
        name: effect.name().to_owned(),
        reason: "the camera hardly moves".to_owned(),
        recording_that_would_decide: effect.recording_that_would_decide().to_owned(),
    }
}

/// Darker towards the corners before, nothing after; a hole in the middle.
fn map(columns: usize, rows: usize, extent: [f64; 4]) -> Map {
    let value = |index: usize, size: f64| {
        let at = |index: usize, count: usize| 2.0 * (index as f64 + 0.5) / count as f64 - 1.0;
        let (x, y) = (at(index % columns, columns), at(index / columns, rows));
        (x.hypot(y) > 0.3).then_some(size * (0.1 - x * x - y * y))
    };
    let values = |size| (0..columns * rows).map(|index| value(index, size)).collect();
    Map { columns, rows, extent, before: values(0.3), after: values(0.03) }
}

fn maps(unit: &str) -> Maps {
    let time_s: Vec<f64> = (0..40).map(|frame| 1000.0 + 0.25 * f64::from(frame)).collect();
    let wave = |size: f64| time_s.iter().map(|time_s| Some(size * (2.0 + time_s.sin()))).collect();
    let judged = (0..40).map(|frame| frame % 4 == 0).collect();
    let time = Course { judged, before: wave(0.1), after: wave(0.02), time_s: time_s.clone() };
    let (picture, field) = (map(8, 6, [0.0, 0.0, 640.0, 480.0]), map(8, 6, [-4.0, 3.0, 4.0, -3.0]));
    Maps { unit: unit.to_owned(), picture, field, time }
}

fn report() -> Report {
    let all = library();
    let photometry = channel([0.24, 0.05, 0.04], "1");
    let geometry = channel([0.31, 0.30, 0.29], "px");
    Report {
        recording: HOSTILE.to_owned(),
        frames: 120,
        judged_frames: 30,
        left_out: vec![HOSTILE.to_owned()],
        verdict: Verdict::Named,
        summary: format!("The lens darkens towards the corners {HOSTILE}."),
        effects: vec![found(all[12])],
        in_model: vec![found(all[13])],
        unexplained: vec![Unexplained {
            channel: "sharpness".to_owned(),
            r#where: "left of the middle, in the lower part".to_owned(),
            size: 0.131,
            unit: "px2".to_owned(),
            p_value: Some(2e-5),
        }],
        gap: Gap {
            before: 4.2,
            after: 1.1,
            floor: 1.0,
            unit: "noise floors".to_owned(),
            channels: by_channel([("photometry", photometry), ("geometry", geometry)]),
        },
        not_found: all[..12].iter().map(|effect| not_found(*effect)).collect(),
        unobservable: all[14..].iter().map(|effect| unobservable(*effect)).collect(),
        poses: PosesReport {
            source: ReferenceSource::Tagged,
            rotation_sigma_rad: [0.002, 0.001, 0.003],
            position_sigma_m: [0.01, 0.012, 0.003],
            absorbed: "a mount that is turned about the vertical".to_owned(),
        },
        maps: by_channel([("photometry", maps("1")), ("geometry", maps("px"))]),
        field: FieldDimensions::preset("humanoid-kidsize-2010").unwrap(),
        shown_frame: 17,
        seed: 0,
    }
}

fn pictures() -> Pictures {
    let picture =
        |dark: u8| RgbImage::from_fn(64, 48, |x, y| Rgb([(3 * x) as u8 - dark, 150 - dark, (4 * y) as u8]));
    Pictures {
        measured: picture(0),
        before: RgbImage::from_pixel(64, 48, Rgb([9, 150, 80])),
        after: picture(0),
        field: GrayImage::from_pixel(64, 48, Luma([255])),
    }
}

/// The page without the pictures' bytes, in which anything may be.
fn without_pictures(page: &str) -> String {
    let mut parts = page.split("base64,");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.filter_map(|part| part.split_once('"')).map(|(_, rest)| rest).collect::<String>()
}

/// Every tag that is opened is closed, in order.
fn assert_balanced(page: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in page.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').expect("a tag ends");
        let name = tag.trim_start_matches('/').split_whitespace().next().unwrap_or_default();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "closed");
        } else if !tag.starts_with('!') && !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?} is not closed");
}

/// A report in which nothing could be measured.
fn hollow() -> Report {
    let empty = Map { columns: 0, rows: 0, extent: [f64::NAN; 4], before: Vec::new(), after: Vec::new() };
    let course =
        Course { time_s: vec![f64::NAN; 3], judged: Vec::new(), before: vec![None; 3], after: Vec::new() };
    let maps = Maps { unit: "px".to_owned(), picture: empty.clone(), field: empty, time: course };
    let nothing = channel([f64::NAN; 3], "px");
    let mut effect = found(library()[12]);
    effect.p_value = f64::NAN;
    effect.held_out_gain = Estimate { value: f64::NAN, sigma: f64::INFINITY, unit: None };
    effect.closes = by_channel([("geometry", f64::NAN)]);
    let gap = Gap {
        before: f64::NAN,
        after: f64::NAN,
        floor: f64::NAN,
        unit: "noise floors".to_owned(),
        channels: by_channel([("geometry", nothing)]),
    };
    let (not_found, unobservable) = (Vec::new(), Vec::new());
    let maps = by_channel([("geometry", maps)]);
    Report { effects: vec![effect], gap, not_found, unobservable, maps, ..report() }
}

#[test]
fn every_effect_is_on_the_page() {
    let page = page(&report(), &pictures());
    for effect in library() {
        assert!(page.contains(&format!("<code>{}</code>", effect.id())), "{}", effect.id());
    }
}

#[test]
fn what_is_text_stays_text() {
    let page = page(&report(), &pictures());
    assert!(!page.contains("<script"));
    assert!(page.contains("&lt;script&gt;alert(&quot;walk&quot;)&lt;/script&gt; &amp; &#39;more&#39;"));
}

#[test]
fn every_tag_is_closed() {
    for report in [report(), hollow()] {
        assert_balanced(&page(&report, &pictures()));
    }
}

#[test]
fn the_page_needs_nothing_else() {
    let page = without_pictures(&page(&report(), &pictures()));
    for outside in ["http", "//", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert_eq!(page.matches("data:image/jpeg;").count(), 5);
}

#[test]
fn what_was_not_measured_is_a_dash() {
    for report in [report(), hollow()] {
        let page = without_pictures(&page(&report, &pictures()));
        assert!(!page.contains("NaN") && !page.contains(">inf") && !page.contains("-0.0"), "{page}");
    }
}

#[test]
fn the_channel_whose_gap_closed_most_is_not_folded() {
    let page = page(&report(), &pictures());
    assert!(page.contains("<h2>Where and when they differ: Photometry</h2>"));
    assert!(page.contains("<details><summary>Geometry</summary>"));
}

#[test]
fn a_report_without_maps_and_pictures_is_a_page() {
    let report = Report { maps: BTreeMap::new(), effects: Vec::new(), unexplained: Vec::new(), ..hollow() };
    let none = || RgbImage::new(0, 0);
    let field = GrayImage::new(0, 0);
    let page = page(&report, &Pictures { measured: none(), before: none(), after: none(), field });
    assert_balanced(&page);
    assert!(page.contains("Nothing significant is left."));
}
