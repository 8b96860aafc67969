use std::collections::BTreeMap;

use image::{GrayImage, Luma, Rgb, RgbImage};
use reality_sim_sensor::library;

use super::*;
use crate::{
    diagnostics::finding::{Finding, PatternCell},
    inference::detection_limit::UnobservableCause,
    recording::ReferenceSource,
    report::data::{
        Course, EffectReport, Estimate, Gap, Limit, Map, NotFoundReport, PosesReport, Unobservable, Verdict,
    },
    testing::{self, effect_report},
};

const HOSTILE: &str = "<script>alert(\"walk\")</script> & 'more'";

fn channel([before, after, floor]: [f64; 3]) -> ChannelGap {
    ChannelGap { before, after, floor, left_out: 0.12 }
}

fn found(id: &str) -> EffectReport {
    EffectReport {
        confusable_with: vec!["uneven_illumination".to_owned()],
        closes: [(Channel::Photometry, 0.93)].into(),
        ..effect_report(id, 0.421)
    }
}

fn not_found(id: &str) -> NotFoundReport {
    let parameter = reality_sim_sensor::effect(id).unwrap().parameters()[0];
    NotFoundReport {
        id: id.to_owned(),
        parameter: parameter.name.to_owned(),
        detection_limit: Limit { value: 2.0 * parameter.material, unit: parameter.unit.to_owned() },
        p_value: 0.4,
        held_out_gain: Estimate { value: -1.2, sigma: 0.8, unit: None, at_range_end: false },
    }
}

fn unobservable(id: &str) -> Unobservable {
    Unobservable { id: id.to_owned(), cause: UnobservableCause::CameraAtRest }
}

/// Returns a map that is darker towards the corners before and flat after, with a hole in the middle.
fn map(columns: usize, rows: usize, extent: [f64; 4]) -> Map {
    let value = |index: usize, size: f64| {
        let at = |index: usize, count: usize| 2.0 * (index as f64 + 0.5) / count as f64 - 1.0;
        let (x, y) = (at(index % columns, columns), at(index / columns, rows));
        (x.hypot(y) > 0.3).then_some(size * (0.1 - x * x - y * y))
    };
    let values = |size| (0..columns * rows).map(|index| value(index, size)).collect();
    Map { columns, rows, extent, before: values(0.3), after: values(0.03) }
}

fn maps() -> Maps {
    let time_s: Vec<f64> = (0..40).map(|frame| 1000.0 + 0.25 * f64::from(frame)).collect();
    let wave = |size: f64| time_s.iter().map(|time_s| Some(size * (2.0 + time_s.sin()))).collect();
    let held_out = (0..40).map(|frame| frame % 4 == 0).collect();
    let time = Course { held_out, before: wave(0.1), after: wave(0.02), time_s: time_s.clone() };
    let (picture, field) = (map(8, 6, [0.0, 0.0, 640.0, 480.0]), map(8, 6, [-4.0, 3.0, 4.0, -3.0]));
    Maps { picture, field, time }
}

fn report() -> Report {
    let ids: Vec<&str> = library().iter().map(|effect| effect.id()).collect();
    let channels = [
        (Channel::Photometry, channel([0.24, 0.05, 0.04])),
        (Channel::Geometry, channel([0.31, 0.30, 0.29])),
    ];
    let strongest = PatternCell::Picture { column: 2, row: 4, grid: [8, 6] };
    Report {
        recording: HOSTILE.to_owned(),
        left_out: vec![HOSTILE.to_owned()],
        verdict: Verdict::Named,
        effects: vec![found(ids[12])],
        in_model: vec![found(ids[13])],
        unexplained: vec![Finding::Pattern {
            channel: Channel::Sharpness,
            strongest,
            size: 0.131,
            p_value: 2e-5,
        }],
        gap: Gap { before: 4.2, after: 1.1, floor: 1.0, channels: channels.into() },
        not_found: ids[..12].iter().map(|id| not_found(id)).collect(),
        unobservable: ids[14..].iter().map(|id| unobservable(id)).collect(),
        poses: PosesReport { source: ReferenceSource::Tagged, ..testing::report().poses },
        maps: [(Channel::Photometry, maps()), (Channel::Geometry, maps())].into(),
        ..testing::report()
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

/// Returns the page without the pictures' bytes, which may contain any text.
fn without_pictures(page: &str) -> String {
    let mut parts = page.split("base64,");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.filter_map(|part| part.split_once('"')).map(|(_, rest)| rest).collect::<String>()
}

/// Asserts that every opened tag is closed, in order.
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

/// Returns a report in which nothing could be measured.
fn hollow() -> Report {
    let empty = Map { columns: 0, rows: 0, extent: [f64::NAN; 4], before: Vec::new(), after: Vec::new() };
    let course =
        Course { time_s: vec![f64::NAN; 3], held_out: Vec::new(), before: vec![None; 3], after: Vec::new() };
    let maps = Maps { picture: empty.clone(), field: empty, time: course };
    let nothing = channel([f64::NAN; 3]);
    let mut effect = found(library()[12].id());
    effect.p_value = f64::NAN;
    effect.held_out_gain =
        Estimate { value: f64::NAN, sigma: f64::INFINITY, unit: None, at_range_end: false };
    effect.closes = [(Channel::Geometry, f64::NAN)].into();
    let gap = Gap {
        before: f64::NAN,
        after: f64::NAN,
        floor: f64::NAN,
        channels: [(Channel::Geometry, nothing)].into(),
    };
    let (not_found, unobservable) = (Vec::new(), Vec::new());
    let maps = [(Channel::Geometry, maps)].into();
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
fn text_is_escaped() {
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
fn the_page_loads_nothing() {
    let page = without_pictures(&page(&report(), &pictures()));
    for outside in ["http", "//", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert_eq!(page.matches("data:image/jpeg;").count(), 5);
}

#[test]
fn values_that_were_not_measured_are_dashes() {
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
