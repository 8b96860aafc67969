//! Simulated pictures with a camera's effects.

use std::{fs, path::Path};

use image::RgbImage;

use super::{assert_fails, demonstration, json, shown};

/// Renders the simulated picture at a pose, with a model file in the folder.
fn simulated(folder: &Path, model: &str) -> RgbImage {
    let (_, database, _) = demonstration();
    let (file, out) = (folder.join("model.toml"), folder.join("out.png"));
    fs::write(&file, model).unwrap();
    let [database, model, picture] = [database, &file, &out].map(|path| shown(path));
    let arguments = ["render", database, "--pose", "-2.05,0.9,1.6", "--method", "simulated"];
    json(&[&arguments[..], &["--model", model, "--out", picture]].concat());
    image::open(&out).unwrap().into_rgb8()
}

#[test]
fn a_model_changes_the_simulated_picture_as_its_effects_say() {
    let own = tempfile::tempdir().unwrap();
    let nominal = simulated(own.path(), "");
    let dark = simulated(own.path(), "[[effect]]\nid = 'vignetting'\nstrength = 0.5\n");
    let still = simulated(own.path(), "[[effect]]\nid = 'rolling_shutter'\nreadout_s = 0.05\n");
    assert!(nominal == still, "nothing moves at a single pose");
    let brightness = |picture: &RgbImage, u, v| picture.get_pixel(u, v).0.map(u32::from).iter().sum::<u32>();
    assert!(brightness(&dark, 2, 477) < brightness(&nominal, 2, 477) * 4 / 5);
    assert!(brightness(&dark, 320, 240).abs_diff(brightness(&nominal, 320, 240)) < 5);
}

#[test]
fn along_a_path_the_simulated_camera_moves() {
    let own = tempfile::tempdir().unwrap();
    let (folder, database, _) = demonstration();
    let path = folder.path().join("probes").join("groundtruth.tum");
    let model = own.path().join("model.toml");
    let pictures = ["nominal", "rolling"].map(|name| {
        let readout_s = if name == "rolling" { 0.06 } else { 0.0 };
        fs::write(&model, format!("[[effect]]\nid = 'rolling_shutter'\nreadout_s = {readout_s}\n")).unwrap();
        let out = own.path().join(name);
        let [database, path, model, out] = [database, &path, &model, &out].map(|path| shown(path));
        let arguments = ["render", database, "--path", path, "--method", "simulated", "--model", model];
        assert_eq!(json(&[&arguments[..], &["--out", out]].concat())["pictures"], 20);
        image::open(Path::new(out).join("000007.png")).unwrap().into_rgb8()
    });
    assert!(pictures[0] != pictures[1]);
}

#[test]
fn a_model_or_path_that_cannot_be_used_is_named() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    let [model, path, out] = ["model.toml", "path.tum", "out"].map(|name| own.path().join(name));
    let fails = |text: &str, expected: &[&str]| {
        fs::write(&model, text).unwrap();
        let [database, model, path, out] = [database, &model, &path, &out].map(|path| shown(path));
        let arguments = ["render", database, "--path", path, "--method", "simulated", "--model", model];
        assert_fails(&[&arguments[..], &["--out", out]].concat(), expected);
    };
    fs::write(&path, "0 1 0 0.5 0 0 0 1\n0.2 1 0 0.5 0 0 0 1\n").unwrap();
    fails("[[effect]]\nid = 'fog'\n", &["model.toml, line 2", "fog", "vignetting"]);
    fails("[[effect]]\nid = 'focal_length'\nscale = -2.0\n", &["model.toml", "focal_length"]);
    fs::write(&path, "1 1 0 0.5 0 0 0 1\n0.2 1 0 0.5 0 0 0 1\n").unwrap();
    fails("", &["path.tum", "does not follow", "sort"]);
}
