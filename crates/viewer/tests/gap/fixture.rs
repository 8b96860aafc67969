//! A report with content in every part, and its folder.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use image::{Rgb, RgbImage};
use reality_sim_core::field::FieldDimensions;
use reality_sim_gap::{
    Channel, ChannelGap, ReferenceSource,
    report::{
        Course, EffectReport, Estimate, Finding, Gap, Limit, Map, Maps, NotFoundReport, Object, ObjectMotion,
        PatternCell, PosesReport, Report, Unobservable, UnobservableCause, Verdict,
    },
};
use tempfile::TempDir;

fn effect(id: &str, parameter: &str) -> EffectReport {
    let estimate = |value, sigma, unit: Option<&str>| Estimate {
        value,
        sigma,
        unit: unit.map(str::to_owned),
        at_range_end: false,
    };
    EffectReport {
        id: id.to_owned(),
        parameters: [(parameter.to_owned(), estimate(0.42, 0.01, Some("1")))].into(),
        correlations: BTreeMap::new(),
        given: BTreeMap::new(),
        p_value: 2e-31,
        held_out_gain: estimate(310.0, 12.0, None),
        confusable_with: Vec::new(),
        closes: [(Channel::Photometry, 0.75)].into(),
    }
}

/// Returns a grid of values that increase to the right, and a sixth of them after; the first cell is empty.
fn map(columns: usize, rows: usize, extent: [f64; 4]) -> Map {
    let value = |cell: usize| (cell > 0).then(|| (cell % columns) as f64 / columns as f64 - 0.5);
    let before: Vec<_> = (0..columns * rows).map(value).collect();
    let after = before.iter().map(|value| value.map(|value| value / 6.0)).collect();
    Map { columns, rows, extent, before, after }
}

fn maps() -> Maps {
    let frames = 12;
    Maps {
        picture: map(16, 12, [0.0, 0.0, 64.0, 48.0]),
        field: map(15, 11, [-3.725, 2.725, 3.725, -2.725]),
        time: Course {
            time_s: (0..frames).map(|frame| 100.0 + 0.2 * f64::from(frame)).collect(),
            held_out: (0..frames).map(|frame| frame % 4 == 0).collect(),
            before: (0..frames).map(|frame| (frame != 5).then_some(0.2 + 0.01 * f64::from(frame))).collect(),
            after: (0..frames).map(|frame| (frame != 5).then_some(0.05)).collect(),
        },
    }
}

/// Returns a report with content in every part.
pub fn report() -> Report {
    let channel = ChannelGap { before: 0.2, after: 0.05, floor: 0.04, left_out: 0.1 };
    let confusable = EffectReport {
        confusable_with: vec!["black_level".to_owned()],
        ..effect("tone_curve", "gamma_change")
    };
    let strongest = PatternCell::Picture { column: 1, row: 3, grid: [8, 6] };
    Report {
        field: FieldDimensions::preset("humanoid-kidsize-2010").unwrap(),
        recording: "hall-3".to_owned(),
        frames: 12,
        held_out_frames: 3,
        left_out: vec!["images/000007.jpg".to_owned()],
        verdict: Verdict::Confusable,
        effects: vec![effect("vignetting", "strength"), confusable],
        in_model: vec![effect("defocus", "sigma_px")],
        unexplained: vec![Finding::Pattern { channel: Channel::Noise, strongest, size: 0.3, p_value: 1e-5 }],
        objects: vec![Object {
            motion: ObjectMotion::Standing,
            share: 0.031,
            pictures: 0.4,
            place_m: Some([1.2, -0.5]),
        }],
        gap: Gap {
            before: 3.1,
            after: 1.2,
            floor: 1.0,
            channels: [(Channel::Geometry, channel.clone()), (Channel::Photometry, channel)].into(),
        },
        not_found: vec![NotFoundReport {
            id: "rolling_shutter".to_owned(),
            parameter: "readout_s".to_owned(),
            detection_limit: Limit { value: 0.021, unit: "s".to_owned() },
            p_value: 1.0,
            held_out_gain: Estimate { value: -1.0, sigma: 2.0, unit: None, at_range_end: false },
        }],
        unobservable: vec![Unobservable {
            id: "time_offset".to_owned(),
            cause: UnobservableCause::CameraAtRest,
        }],
        poses: PosesReport {
            source: ReferenceSource::Measured,
            rotation_sigma_rad: [0.002; 3],
            position_sigma_m: [0.003; 3],
        },
        maps: [(Channel::Geometry, maps()), (Channel::Photometry, maps())].into(),
        shown_frame: 10,
        seed: 0,
    }
}

/// Returns a picture that darkens towards its edges by a fraction of its brightness.
fn picture(darker: f32) -> RgbImage {
    RgbImage::from_fn(64, 48, |x, y| {
        let (x, y) = (x as f32 / 32.0 - 1.0, y as f32 / 24.0 - 1.0);
        let light = 1.0 - darker * (x * x + y * y) / 2.0;
        Rgb([60.0, 150.0, 80.0].map(|value| (light * value) as u8))
    })
}

/// Writes a report as the program does.
pub fn write(folder: &Path, report: &Report) {
    fs::create_dir_all(folder.join("pictures")).unwrap();
    fs::write(folder.join("report.json"), serde_json::to_string(report).unwrap()).unwrap();
    fs::write(folder.join("report.html"), "<!doctype html>").unwrap();
    for (name, darker) in [("measured.png", 0.5), ("before.png", 0.0), ("after.png", 0.48)] {
        picture(darker).save(folder.join("pictures").join(name)).unwrap();
    }
}

pub fn written(report: &Report) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("found");
    write(&path, report);
    (folder, path)
}
