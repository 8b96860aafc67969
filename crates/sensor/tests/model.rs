//! Reading and writing of `model.toml`.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod scene;

use std::{fs, path::Path};

use proptest::prelude::*;
use reality_sim_sensor::{Chain, Model, effect, library};

fn parsed(text: &str) -> Result<Model, String> {
    Model::from_toml(Path::new("model.toml"), text).map_err(|error| error.to_string())
}

fn any_model() -> impl Strategy<Value = Model> {
    let value = prop_oneof![-2.0..2.0, -1e-9..1e-9, -1e18..1e18, Just(0.0), Just(1.0)];
    let values = proptest::collection::vec(value, 14);
    proptest::collection::vec((0..library().len(), values), 0..8).prop_map(|effects| {
        effects
            .into_iter()
            .fold(Model::default(), |model, (index, values)| model.with(library()[index], values))
    })
}

proptest! {
    #[test]
    fn a_model_reads_back_as_it_was_written(model in any_model()) {
        prop_assert_eq!(parsed(&model.to_toml()).unwrap(), model);
    }
}

#[test]
fn the_file_says_what_its_numbers_are() {
    let model = Model::default().with(effect("vignetting").unwrap(), [0.52]);
    let expected = "# Effects of the simulated camera beside what camera.toml says, as positive values have them; neutral values: no effect.\n\n\
        [[effect]]\nid = \"vignetting\"  # the lens darkens towards the corners\n\
        strength = 0.52  # 1\nshape = 0.0  # 1\nbend = 0.0  # 1\n";
    assert_eq!(model.to_toml(), expected);
}

#[test]
fn what_is_left_out_is_neutral_and_whole_numbers_are_numbers() {
    let text = "[[effect]]\nid = 'principal_point'\ny_px = 4\n\n[[effect]]\nid = 'defocus'\n";
    let model = parsed(text).unwrap();
    assert_eq!(model.values("principal_point").unwrap(), [0.0, 4.0]);
    assert_eq!(model.values("defocus").unwrap(), [0.0]);
    assert_eq!(model.values("vignetting"), None);
    assert_eq!(parsed("").unwrap(), Model::default());
}

#[test]
fn values_of_an_effect_are_replaced_filled_up_and_cut_off() {
    let [vignetting, defocus] = ["vignetting", "defocus"].map(|id| effect(id).unwrap());
    let model =
        Model::default().with(vignetting, [0.1, 0.2]).with(defocus, [1.0]).with(vignetting, vec![0.3]);
    assert_eq!(model.effects.len(), 2);
    assert_eq!(model.values("vignetting").unwrap(), [0.3, 0.0, 0.0]);
    assert_eq!(model.with(defocus, [2.0, 5.0, 6.0]).values("defocus").unwrap(), [2.0]);
}

#[test]
fn a_faulty_model_is_refused_with_its_line_its_fault_and_what_to_do() {
    let cases = [
        (
            "[[effect]]\nid = 'fog'\n",
            "model.toml, line 2: the effect \"fog\" is not known: use one of field_dimensions, ",
        ),
        (
            "[[effect]]\nstrength = 1.0\n",
            "model.toml, line 1: the key `id` is missing: add the effect's name, one of ",
        ),
        ("[[effect]]\nid = 3\n", "model.toml, line 2: the key `id` is missing: add "),
        (
            "[[effect]]\nid = 'vignetting'\nstrenght = 0.5\n",
            "model.toml, line 3: the key `strenght` is not known: vignetting has strength, shape, bend",
        ),
        (
            "[[effect]]\nid = 'defocus'\nsigma_px = nan\n",
            "model.toml, line 3: `sigma_px` of defocus is not a finite number: correct it",
        ),
        (
            "[[effect]]\nid = 'defocus'\nsigma_px = '1'\n",
            "model.toml, line 3: `sigma_px` of defocus is not a number: correct it",
        ),
        (
            "[[effect]]\nid = 'defocus'\n[[effect]]\nid = 'defocus'\n",
            "model.toml, line 3: the effect defocus is there twice: keep one",
        ),
        (
            "\n[[effects]]\nid = 'defocus'\n",
            "model.toml, line 2: the key `effects` is not known: a model holds tables [[effect]] only",
        ),
        (
            "effect = 3\n",
            "model.toml, line 1: `effect` is not a list of tables: begin each effect with a line [[effect]]",
        ),
        (
            "effect = [3]\n",
            "model.toml, line 1: `effect` is not a list of tables: begin each effect with a line [[effect]]",
        ),
        ("[[effect]\n", "model.toml, line 1: "),
    ];
    for (text, message) in cases {
        let error = parsed(text).unwrap_err();
        assert!(error.starts_with(message), "{error}");
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn a_file_that_is_none_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.toml");
    let not_text = folder.path().join("not_text.toml");
    fs::write(&not_text, b"# one\n# \xff\n").unwrap();
    let cases = [
        (missing.as_path(), "there is no such file"),
        (folder.path(), "is not a regular file"),
        (not_text.as_path(), "is not UTF-8 text"),
    ];
    for (path, message) in cases {
        let error = Model::read(path).unwrap_err().to_string();
        assert!(error.starts_with(&path.display().to_string()) && error.contains(message), "{error}");
    }
    assert!(Model::read(&not_text).unwrap_err().to_string().contains(", line 2: "));
    let good = folder.path().join("good.toml");
    let model = Model::default().with(effect("defocus").unwrap(), [1.5]);
    fs::write(&good, format!("\u{feff}{}", model.to_toml())).unwrap();
    assert_eq!(Model::read(&good).unwrap(), model);
}

#[test]
fn effects_that_leave_no_camera_are_named() {
    let setup = scene::linear_setup(scene::fisheye([64, 48], 22.0));
    let cases = [
        ("focal_length", vec![-1.5], "the model: with focal_length, fx and fy must be positive"),
        ("radial_distortion", vec![f64::NAN], "the model: `k1` of radial_distortion is not a finite number"),
        (
            "tone_curve",
            vec![-1.0],
            "the model: the gamma would be 0: bring gamma_change of tone_curve nearer to 0",
        ),
    ];
    for (id, values, message) in cases {
        let model = Model::default().with(effect(id).unwrap(), values);
        let error = Chain::new(&setup, &scene::field(), &model).unwrap_err();
        assert!(error.to_string().starts_with(message), "{error}");
        assert!(error.in_file(Path::new("m.toml")).to_string().starts_with("m.toml: "));
    }
}
