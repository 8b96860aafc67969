//! Tests of whole recordings: the files written, the changes by each effect, and what stays the same.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{collections::BTreeMap, fs, path::Path};

use reality_sim_core::sequence::Sequence;
use reality_sim_hidden::{FOREIGN, Hidden, LIBRARY, Random, Recipe, Walk};

const SEED: u64 = 11;

fn recipe(effects: Vec<Hidden>) -> Recipe {
    Recipe { frames: 4, size: [160, 120], effects, ..Recipe::new(SEED) }
}

/// Returns every file of a recording by its name in the folder; all pictures share one name.
fn files(recipe: &Recipe) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    recipe.record(folder.path()).unwrap();
    let names = ["sequence.toml", "camera.toml", "field.toml", "frames.csv", "groundtruth.tum"];
    let mut files: BTreeMap<_, _> =
        names.map(|name| (name.to_owned(), fs::read(folder.path().join(name)).unwrap())).into();
    let picture = |frame: usize| fs::read(folder.path().join(format!("images/{frame:06}.jpg"))).unwrap();
    files.insert("images".to_owned(), (0..recipe.frames).flat_map(picture).collect());
    files
}

/// Returns the names of the files that an effect changes.
fn changed(plain: &BTreeMap<String, Vec<u8>>, id: &str) -> Vec<String> {
    let effect = Hidden::of(id, 8.0, &mut Random::new(3)).unwrap();
    let hidden = files(&recipe(vec![effect]));
    plain.iter().filter(|(name, bytes)| hidden[*name] != **bytes).map(|(name, _)| name.clone()).collect()
}

#[test]
fn every_effect_changes_what_it_acts_on_and_nothing_else() {
    let plain = files(&recipe(Vec::new()));
    for id in LIBRARY.iter().chain(&FOREIGN) {
        let expected: &[&str] = match *id {
            "time_offset" => &["frames.csv", "images"],
            id if id.starts_with("odometry") => &["frames.csv"],
            _ => &["images"],
        };
        assert_eq!(changed(&plain, id), expected, "{id}");
    }
}

#[test]
fn the_same_recipe_gives_the_same_bytes_and_another_seed_others() {
    let first = files(&recipe(Vec::new()));
    assert!(first == files(&recipe(Vec::new())));
    let other = files(&Recipe { seed: SEED + 1, ..recipe(Vec::new()) });
    assert!(first.iter().all(|(name, bytes)| name == "field.toml" || other[name] != *bytes));
}

#[test]
fn a_recording_reads_back_as_a_sequence_with_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let given = recipe(Vec::new()).record(folder.path()).unwrap();
    let sequence = Sequence::open(folder.path()).unwrap();
    assert_eq!(given, sequence);
    assert_eq!(sequence.frames.len(), 4);
    assert!(sequence.start.is_some() && sequence.reference_poses().all(|pose| pose.is_some()));
    let photometry = sequence.setup.photometry.unwrap();
    assert!(photometry.line_linear_rgb.is_some() && photometry.psf_sigma_px == Some(0.5));
    for frame in 0..4 {
        assert_eq!(sequence.load_image(frame).unwrap().dimensions(), (160, 120));
    }
}

#[test]
fn pictures_of_a_standing_robot_differ_by_their_noise_alone() {
    let folder = tempfile::tempdir().unwrap();
    let sequence = Recipe { walk: Walk::Standing, ..recipe(Vec::new()) }.record(folder.path()).unwrap();
    let pictures = [0, 3].map(|frame| sequence.load_image(frame).unwrap());
    let differences = pictures[0].iter().zip(pictures[1].iter()).map(|(a, b)| f64::from(a.abs_diff(*b)));
    let mean = differences.sum::<f64>() / pictures[0].len() as f64;
    assert!(mean > 1.0 && mean < 10.0, "{mean}");
}

#[test]
fn impossible_recipes_are_refused() {
    let nowhere = Path::new("not-written");
    let refused = |recipe: Recipe| recipe.record(nowhere).unwrap_err().to_string();
    assert!(refused(Recipe { frames: 0, ..recipe(Vec::new()) }).contains("frames"));
    assert!(refused(Recipe { size: [0, 120], ..recipe(Vec::new()) }).contains("size"));
    assert!(refused(recipe(vec![Hidden::TimeOffset { offset_s: f64::NAN }])).contains("time_offset"));
    assert!(!nowhere.exists());
}
