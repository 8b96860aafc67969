//! Controls: effects that are hidden in a recording of one's own, and whether they are named.

use std::path::Path;

use serde_json::Value;

use crate::common::{program, shown};

/// Runs `gap --inject` on 32 pictures of a recording of `assets/` and returns the report that it prints.
fn control(recording: &str, inject: &str) -> Value {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(recording);
    let out = tempfile::tempdir().unwrap();
    let report = out.path().join("report");
    let gap = ["gap", shown(&folder), "--out", shown(&report), "--json"];
    let output = program(&[&gap[..], &["--frames", "0..32", "--inject", inject]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn size(report: &Value, id: &str, parameter: &str) -> f64 {
    let found = report["effects"].as_array().unwrap().iter().find(|effect| effect["id"] == id);
    found.unwrap()["parameters"][parameter]["value"].as_f64().unwrap()
}

#[test]
fn an_effect_that_is_hidden_in_the_files_is_named_with_its_size() {
    let report = control("walk", "mount_pitch=0.02");
    assert_eq!((&report["named"], &report["injected"]["id"]), (&true.into(), &"mount_pitch".into()));
    assert!((size(&report, "mount_pitch", "pitch_rad") - 0.02).abs() < 0.002, "{report}");
}

#[test]
fn an_effect_that_is_hidden_in_the_pictures_is_named_beside_the_one_that_is_there() {
    let report = control("pitch", "defocus=1.2");
    assert_eq!(report["named"], true, "{}", report["summary"]);
    assert!((size(&report, "defocus", "sigma_px") - 1.2).abs() < 0.25, "{}", report["summary"]);
    assert!((size(&report, "mount_pitch", "pitch_rad") + 0.0175).abs() < 0.004, "{}", report["summary"]);
}

#[test]
fn a_control_that_is_too_small_is_not_named() {
    let report = control("walk", "mount_pitch=0.0002");
    assert_eq!(report["named"], false);
    assert_eq!(report["injected"]["value"], 0.0002);
}
