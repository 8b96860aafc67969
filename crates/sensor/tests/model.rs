//! Reading and writing of `model.toml`.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use std::{fs, path::Path};

use proptest::prelude::*;
use reality_sim_sensor::{Chain, InvalidTone, Model, ModelError, ModelFault, effect, library};

/// Test of a fault.
type Check = fn(&ModelFault) -> bool;

fn parsed(text: &str) -> Result<Model, ModelError> {
    Model::from_toml(Path::new("model.toml"), text)
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
fn the_file_explains_its_values() {
    let model = Model::default().with(effect("vignetting").unwrap(), [0.52]);
    let expected = "# Effects of the simulated camera beside what camera.toml says, as positive values have them; neutral values: no effect.\n\n\
        [[effect]]\nid = \"vignetting\"  # the lens darkens towards the corners\n\
        strength = 0.52  # 1\nshape = 0.0  # 1\nbend = 0.0  # 1\n";
    assert_eq!(model.to_toml(), expected);
}

#[test]
fn omitted_values_are_neutral_and_integers_are_accepted() {
    let text = "[[effect]]\nid = 'principal_point'\ny_px = 4\n\n[[effect]]\nid = 'defocus'\n";
    let model = parsed(text).unwrap();
    assert_eq!(model.values("principal_point").unwrap(), [0.0, 4.0]);
    assert_eq!(model.values("defocus").unwrap(), [0.0]);
    assert_eq!(model.values("vignetting"), None);
    assert_eq!(parsed("").unwrap(), Model::default());
}

#[test]
fn values_of_an_effect_are_replaced_padded_and_truncated() {
    let [vignetting, defocus] = ["vignetting", "defocus"].map(|id| effect(id).unwrap());
    let model =
        Model::default().with(vignetting, [0.1, 0.2]).with(defocus, [1.0]).with(vignetting, vec![0.3]);
    assert_eq!(model.effects.len(), 2);
    assert_eq!(model.values("vignetting").unwrap(), [0.3, 0.0, 0.0]);
    assert_eq!(model.with(defocus, [2.0, 5.0, 6.0]).values("defocus").unwrap(), [2.0]);
}

#[test]
fn a_faulty_model_is_refused_with_its_line_and_its_fault() {
    use ModelFault::{
        MissingId, NotANumber, NotFinite, NotTables, Toml, Twice, UnknownEffect, UnknownKey, UnknownTable,
    };

    let cases: [(&str, usize, Check); 11] = [
        ("[[effect]]\nid = 'fog'\n", 2, |fault| matches!(fault, UnknownEffect { id } if id == "fog")),
        ("[[effect]]\nstrength = 1.0\n", 1, |fault| matches!(fault, MissingId)),
        ("[[effect]]\nid = 3\n", 2, |fault| matches!(fault, MissingId)),
        (
            "[[effect]]\nid = 'vignetting'\nstrenght = 0.5\n",
            3,
            |fault| matches!(fault, UnknownKey { id: "vignetting", key, .. } if key == "strenght"),
        ),
        ("[[effect]]\nid = 'defocus'\nsigma_px = nan\n", 3, |fault| {
            matches!(fault, NotFinite { id: "defocus", key: "sigma_px" })
        }),
        ("[[effect]]\nid = 'defocus'\nsigma_px = '1'\n", 3, |fault| {
            matches!(fault, NotANumber { id: "defocus", key: "sigma_px" })
        }),
        ("[[effect]]\nid = 'defocus'\n[[effect]]\nid = 'defocus'\n", 3, |fault| {
            matches!(fault, Twice { id: "defocus" })
        }),
        (
            "\n[[effects]]\nid = 'defocus'\n",
            2,
            |fault| matches!(fault, UnknownTable { key } if key == "effects"),
        ),
        ("effect = 3\n", 1, |fault| matches!(fault, NotTables)),
        ("effect = [3]\n", 1, |fault| matches!(fault, NotTables)),
        ("[[effect]\n", 1, |fault| matches!(fault, Toml { .. })),
    ];
    for (text, line, is_expected) in cases {
        let error = parsed(text).unwrap_err();
        assert_eq!(
            (error.path.as_deref(), error.line),
            (Some(Path::new("model.toml")), Some(line)),
            "{text}"
        );
        assert!(is_expected(&error.fault), "{text}: {:?}", error.fault);
        assert!(!error.to_string().contains('\n'), "{error}");
    }
}

#[test]
fn a_path_without_a_readable_model_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.toml");
    let not_text = folder.path().join("not_text.toml");
    fs::write(&not_text, b"# one\n# \xff\n").unwrap();
    let cases: [(&Path, Option<usize>, Check); 3] = [
        (&missing, None, |fault| matches!(fault, ModelFault::Missing)),
        (folder.path(), None, |fault| matches!(fault, ModelFault::NotAFile)),
        (&not_text, Some(2), |fault| matches!(fault, ModelFault::NotUtf8)),
    ];
    for (path, line, is_expected) in cases {
        let error = Model::read(path).unwrap_err();
        assert_eq!((error.path.as_deref(), error.line), (Some(path), line));
        assert!(is_expected(&error.fault), "{:?}", error.fault);
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    }
    let good = folder.path().join("good.toml");
    let model = Model::default().with(effect("defocus").unwrap(), [1.5]);
    fs::write(&good, format!("\u{feff}{}", model.to_toml())).unwrap();
    assert_eq!(Model::read(&good).unwrap(), model);
}

#[test]
fn effects_that_leave_no_camera_or_no_tone_curve_are_named() {
    let setup = common::linear_setup(common::fisheye([64, 48], 22.0));
    let cases: [(&str, f64, Check); 3] = [
        ("focal_length", -1.5, |fault| matches!(fault, ModelFault::Camera { id: "focal_length", .. })),
        ("radial_distortion", f64::NAN, |fault| {
            matches!(fault, ModelFault::NotFinite { id: "radial_distortion", key: "k1" })
        }),
        ("tone_curve", -1.0, |fault| {
            matches!(fault, ModelFault::Tone { id: "tone_curve", error: InvalidTone { gamma: 0.0 } })
        }),
    ];
    for (id, value, is_expected) in cases {
        let model = Model::default().with(effect(id).unwrap(), [value]);
        let error = Chain::new(&setup, &common::field(), &model).unwrap_err();
        assert!(is_expected(&error.fault), "{:?}", error.fault);
        assert_eq!(error.in_file(Path::new("m.toml")).path.as_deref(), Some(Path::new("m.toml")));
    }
}

/// What may stand in the place of a word or a number.
const HOSTILE_WORDS: [&str; 12] = [
    "nan",
    "-inf",
    "1e999",
    "-1",
    "99999999999999999999",
    "\"",
    "[",
    "]",
    "=",
    "\n",
    "\u{1b}[2J",
    "\u{2028}",
];

proptest! {
    #[test]
    fn a_hostile_model_is_read_or_refused_on_one_line(
        model in any_model(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), 0..HOSTILE_WORDS.len(), any::<bool>()), 1..5),
    ) {
        let mut text = model.to_toml();
        for (place, word, replaces) in changes {
            let starts: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
            let from = *place.get(&starts);
            let rest = text[from..].find([' ', '\n']).unwrap_or(0);
            text.replace_range(from..from + if replaces { rest } else { 0 }, HOSTILE_WORDS[word]);
        }
        match parsed(&text) {
            Ok(model) => prop_assert_eq!(parsed(&model.to_toml()).unwrap(), model),
            Err(error) => {
                let message = error.to_string();
                prop_assert!(!message.contains(char::is_control) && !message.is_empty(), "{:?}", message);
            }
        }
    }
}
