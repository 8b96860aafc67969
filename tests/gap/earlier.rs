//! `gap --reference`: what has changed since an earlier recording by the same camera, without nominal values.

use std::{fs, path::Path};

use reality_sim_hidden::{Falloff, Hidden, Recipe};
use serde_json::Value;

use crate::{
    common::{assert_fails, program, shown},
    small,
};

/// Records a walk in one hall, whose camera file tells nothing of brightness, noise and sharpness.
fn record(folder: &Path, seed: u64, effects: &[Hidden]) {
    let recipe = Recipe { effects: effects.to_vec(), ..small(seed) };
    recipe.record(folder).unwrap();
    let camera = folder.join("camera.toml");
    let text = fs::read_to_string(&camera).unwrap();
    let (geometry, _) = text.split_once("[photometry]").unwrap();
    fs::write(&camera, format!("{geometry}[photometry]\ngamma = 2.2\n")).unwrap();
}

/// Returns the report on what has changed from a walk with some effects to another one with others.
fn since(earlier: &[Hidden], later: &[Hidden]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let [before, after, out] = ["before", "after", "out"].map(|name| folder.path().join(name));
    record(&before, 131, earlier);
    record(&after, 132, later);
    let output =
        program(&["gap", shown(&after), "--reference", shown(&before), "--json", "--out", shown(&out)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn ids(report: &Value, key: &str) -> Vec<String> {
    let effects = report[key].as_array().unwrap().iter();
    effects.map(|effect| effect["id"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn a_focus_ring_that_moved_between_two_recordings_is_named_without_a_nominal_sharpness() {
    let report = since(&[], &[Hidden::Defocus { sigma_px: 1.5 }]);
    assert_eq!(ids(&report, "effects"), ["defocus"], "{}", report["summary"]);
    assert_eq!(report["reference"]["effects"], Value::Array(Vec::new()));
}

#[test]
fn a_report_is_not_written_into_the_earlier_recording() {
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = ["before", "after"].map(|name| folder.path().join(name));
    record(&before, 131, &[]);
    record(&after, 132, &[]);
    let camera = fs::read_to_string(before.join("camera.toml")).unwrap();
    let refused = ["gap", shown(&after), "--reference", shown(&before), "--out", shown(&before)];
    assert_fails(&refused, &["holds the input"]);
    assert_eq!(fs::read_to_string(before.join("camera.toml")).unwrap(), camera);
}

#[test]
fn an_effect_of_both_recordings_has_not_changed() {
    let vignetting = Hidden::Vignetting { strength: 0.6, falloff: Falloff::Quadratic };
    let report = since(&[vignetting], &[vignetting]);
    assert_eq!(ids(&report, "effects"), Vec::<String>::new(), "{}", report["summary"]);
    assert_eq!(report["reference"]["effects"][0], "vignetting");
    assert_eq!(ids(&report, "in_model"), ["vignetting"]);
}
