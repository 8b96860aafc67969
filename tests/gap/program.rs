//! `reality-sim gap`, run as users run it.

use std::fs;

use serde_json::Value;

use reality_sim_hidden::Hidden;

use crate::{
    common::{assert_fails, program, shown},
    record,
};

#[test]
fn the_program_writes_a_report_a_page_pictures_and_a_model_that_it_takes_again() {
    let (folder, _sequence) = record(81, &[Hidden::MountPitch { angle_rad: -0.02 }]);
    let out = folder.path().join("report");
    let output = program(&["gap", shown(folder.path()), "--out", shown(&out), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    let written: Value = serde_json::from_str(&fs::read_to_string(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(printed, written);
    assert_eq!(written["verdict"], "named");
    let effect = &written["effects"][0];
    assert_eq!(effect["id"], "mount_pitch");
    assert!(effect["parameters"]["pitch_rad"]["value"].as_f64().unwrap() < -0.015);
    assert_eq!(effect["parameters"]["pitch_rad"]["unit"], "rad");
    for key in ["p_value", "held_out_gain", "confusable_with", "because"] {
        assert!(!effect[key].is_null(), "{key}");
    }
    for key in ["before", "after", "floor", "unit", "channels"] {
        assert!(!written["gap"][key].is_null(), "{key}");
    }
    assert!(written["not_found"][0]["detection_limit"]["value"].as_f64().unwrap() > 0.0);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    // Its pictures are embedded: nothing is fetched.
    let fetched =
        page.match_indices("src=\"").all(|(at, _)| page[at..].starts_with("src=\"data:image/jpeg;base64,"));
    assert!(page.contains("mount_pitch") && fetched && !page.contains("href="), "self-contained");
    for name in ["measured", "before", "after"] {
        assert_eq!(image::open(out.join(format!("pictures/{name}.png"))).unwrap().width(), 320);
    }
    let again = folder.path().join("again");
    let model = out.join("model.toml");
    let output =
        program(&["gap", shown(folder.path()), "--model", shown(&model), "--out", shown(&again), "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["effects"], Value::Array(Vec::new()));
    assert_eq!(report["in_model"][0]["id"], "mount_pitch");
}

#[test]
fn poses_of_the_particle_filter_suffice_and_the_report_states_what_they_absorb() {
    let (folder, _sequence) = record(91, &[Hidden::MountPitch { angle_rad: 0.03 }]);
    let out = folder.path().join("report");
    let output =
        program(&["gap", shown(folder.path()), "--tag", "--backend", "cpu", "--out", shown(&out), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["poses"]["source"], "tagged");
    assert!(!report["poses"]["absorbed"].as_str().unwrap().is_empty());
    assert_eq!(report["effects"][0]["id"], "mount_pitch", "{report}");
}

#[test]
fn broken_pictures_are_left_out_and_named() {
    let (folder, sequence) = record(101, &[]);
    let picture = sequence.image_path(5).unwrap();
    let bytes = fs::read(&picture).unwrap();
    fs::write(&picture, &bytes[..bytes.len() / 2]).unwrap();
    fs::remove_file(sequence.image_path(9).unwrap()).unwrap();
    let out = folder.path().join("report");
    let output = program(&["gap", shown(folder.path()), "--out", shown(&out), "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["frames"], 30);
    assert_eq!(report["left_out"].as_array().unwrap().len(), 2);
    fs::remove_dir_all(folder.path().join("images")).unwrap();
    let refused = ["gap", shown(folder.path()), "--out", shown(&out)];
    assert_fails(&refused, &["32 of its 32 pictures are missing", "000000.jpg"]);
}

#[test]
fn bad_input_is_one_sentence() {
    let (folder, _sequence) = record(121, &[]);
    let (input, out) = (shown(folder.path()), folder.path().join("report"));
    let out = shown(&out);
    assert_fails(&["gap", "no/such/folder", "--out", out], &["no/such/folder"]);
    assert_fails(
        &["gap", input, "--out", shown(&folder.path().join("camera.toml/report"))],
        &["camera.toml"],
    );
    assert_fails(&["gap", input, "--out", input], &["holds the input"]);
    assert_fails(&["gap", input, "--frames", "0..5", "--out", out], &["5 of the 5 frames", "at least 12"]);
    assert_fails(&["gap", input, "--frames", "20..90", "--out", out], &["frames 0 to 31"]);
    let model = folder.path().join("model.toml");
    fs::write(&model, "[[effect]]\nid = \"gremlins\"\n").unwrap();
    assert_fails(&["gap", input, "--model", shown(&model), "--out", out], &["model.toml", "gremlins"]);
    fs::write(&model, "[[effect]]\nid = \"vignetting\"\nstrength = nan\n").unwrap();
    assert_fails(&["gap", input, "--model", shown(&model), "--out", out], &["model.toml", "strength"]);
    fs::write(&model, "[[effect]]\nid = \"focal_length\"\nscale = -1.0\n").unwrap();
    let fresh = folder.path().join("fresh");
    let refused = ["gap", input, "--model", shown(&model), "--out", shown(&fresh)];
    assert_fails(&refused, &["model.toml", "focal"]);
    assert!(!fresh.exists(), "nothing is made for what is refused");
    fs::write(&model, "[[effect]]\nid = \"camera_height\"\nheight_m = -2.0\n").unwrap();
    assert_fails(&["gap", input, "--model", shown(&model), "--out", out], &["frame 0", "camera_height"]);
    assert_eq!(program(&["gap", input, "--frames", "9..3", "--out", out]).status.code(), Some(2));
    assert_eq!(program(&["gap", input]).status.code(), Some(2));
}
