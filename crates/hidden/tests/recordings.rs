//! Tests of whole recordings: the files written, the changes by each effect, and what stays the same.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{collections::BTreeMap, fs, path::Path};

use reality_sim_core::sequence::Sequence;
use reality_sim_hidden::{FOREIGN, Falloff, Given, Hidden, LIBRARY, MISTAKES, Random, Recipe, Takes, Walk};

const SEED: u64 = 11;

fn recipe(effects: Vec<Hidden>) -> Recipe {
    Recipe { frames: 4, size: [160, 120], effects, ..Recipe::new(SEED) }
}

/// Returns every file of a recording by its name in the folder; all pictures share one name.
fn files(recipe: &Recipe) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    recipe.record(folder.path()).unwrap();
    read(folder.path())
}

fn read(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = ["sequence.toml", "camera.toml", "field.toml", "frames.csv", "groundtruth.tum"];
    let mut files: BTreeMap<_, _> =
        names.map(|name| (name.to_owned(), fs::read(folder.join(name)).unwrap())).into();
    let pictures = fs::read_dir(folder.join("images")).unwrap().map(|entry| entry.unwrap().path());
    let pictures: BTreeMap<_, _> = pictures.map(|path| (path.clone(), fs::read(path).unwrap())).collect();
    files.insert("images".to_owned(), pictures.into_values().flatten().collect());
    files
}

/// Returns the names of the files that differ.
fn changed(plain: &BTreeMap<String, Vec<u8>>, hidden: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    plain.iter().filter(|(name, bytes)| hidden[*name] != **bytes).map(|(name, _)| name.clone()).collect()
}

fn effect(id: &str) -> Hidden {
    Hidden::of(id, 8.0, &mut Random::new(3)).unwrap()
}

/// Returns all effects that a few pictures can have.
fn all() -> impl Iterator<Item = &'static str> {
    let few = |id: &&str| !["lost_frames", "doubled_frames"].contains(id);
    LIBRARY.into_iter().chain(FOREIGN).chain(MISTAKES).filter(few)
}

/// Returns the files that an effect changes beside the same pictures in any world.
fn beside_pictures(id: &str) -> Option<&'static [&'static str]> {
    Some(match id {
        "imu_delay" | "degrees_for_radians" => &["frames.csv"],
        "clock_jump" => &["frames.csv", "groundtruth.tum"],
        "swapped_axes" | "negated_axis" | "millimetres_for_metres" | "inverted_poses" => &["groundtruth.tum"],
        "another_leagues_field" => &["field.toml"],
        id if id.starts_with("odometry") => &["frames.csv"],
        _ => return None,
    })
}

#[test]
fn every_effect_changes_what_it_acts_on_and_nothing_else() {
    let plain = files(&recipe(Vec::new()));
    for id in all() {
        let pictures: &[&str] = if id == "time_offset" { &["frames.csv", "images"] } else { &["images"] };
        let expected = beside_pictures(id).unwrap_or(pictures);
        assert_eq!(changed(&plain, &files(&recipe(vec![effect(id)]))), expected, "{id}");
    }
}

/// Recipe of a drawn world with a fisheye and with everything told.
fn drawn(frames: usize) -> Recipe {
    Recipe { frames, size: [160, 120], given: Some(Given::ALL), ..Recipe::drawn(1005) }
}

fn written(takes: &Takes, effects: &[Hidden]) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    takes.record(effects, folder.path()).unwrap();
    read(folder.path())
}

#[test]
fn in_a_drawn_world_effects_are_hidden_beside_the_same_pictures_where_that_is_possible() {
    let takes = drawn(4).takes().unwrap();
    let plain = written(&takes, &[]);
    // The goal area that is not painted is not in view in this world.
    for id in all().filter(|id| *id != "missing_line") {
        let expected: &[&str] = match id {
            "radial_distortion" | "principal_point" | "focal_length" => &["camera.toml"],
            "carpet_reflectance" | "line_reflectance" => &["camera.toml"],
            "camera_height" => &["camera.toml", "groundtruth.tum"],
            "mount_pitch" | "mount_roll" | "gait_sway" => &["frames.csv", "groundtruth.tum"],
            "camera_yaw" | "camera_offset" => &["frames.csv", "groundtruth.tum", "sequence.toml"],
            "time_offset" => &["groundtruth.tum", "sequence.toml"],
            "field_dimensions" => &["field.toml"],
            id => beside_pictures(id).unwrap_or(&["images"]),
        };
        assert_eq!(changed(&plain, &written(&takes, &[effect(id)])), expected, "{id}");
    }
}

#[test]
fn pictures_taken_once_or_for_each_recording_are_the_same() {
    let takes = drawn(3).takes().unwrap();
    let vignetting = Hidden::Vignetting { strength: 0.3, falloff: Falloff::Quadratic };
    for effects in [vec![], vec![vignetting], vec![effect("rolling_shutter"), effect("mount_pitch")]] {
        let once = files(&Recipe { effects: effects.clone(), ..drawn(3) });
        assert!(once == written(&takes, &effects), "{effects:?}");
    }
}

#[test]
fn lost_pictures_are_those_of_later_frames_and_doubled_ones_those_of_earlier() {
    let recipe = drawn(10);
    let pictures = |effects: &[Hidden]| {
        let folder = tempfile::tempdir().unwrap();
        let sequence = Recipe { effects: effects.to_vec(), ..recipe.clone() }.record(folder.path()).unwrap();
        (0..sequence.frames.len()).map(|frame| sequence.load_image(frame).unwrap()).collect::<Vec<_>>()
    };
    let plain = pictures(&[]);
    let lost = pictures(&[Hidden::LostFrames { count: 2 }]);
    assert!(lost.len() == 8 && lost[..4] == plain[..4] && lost[4..] == plain[6..]);
    let doubled = pictures(&[Hidden::DoubledFrames { count: 1 }]);
    assert!(doubled[4] == plain[3] && doubled[..4] == plain[..4] && doubled[5..] == plain[5..]);
}

#[test]
fn reference_poses_at_a_rate_of_their_own_are_those_of_the_same_path() {
    let folder = tempfile::tempdir().unwrap();
    let rate_hz = 100.0;
    let recipe = Recipe { reference_rate_hz: Some(rate_hz), ..recipe(Vec::new()) };
    recipe.record(folder.path()).unwrap();
    let text = fs::read_to_string(folder.path().join("groundtruth.tum")).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 100);
    let speeds = rows.windows(20).map(|rows| (rows[19][1] - rows[0][1]).hypot(rows[19][2] - rows[0][2]));
    let fastest = speeds.fold(0.0, f64::max) / 0.19;
    assert!((0.05..0.6).contains(&fastest), "a robot that walks: {fastest} m/s");
}

#[test]
fn drawn_worlds_differ_from_each_other_and_are_the_same_for_a_seed() {
    let of_seed = |seed: u64| files(&Recipe { frames: 2, size: [64, 48], ..Recipe::drawn(seed) });
    let (one, other) = (of_seed(1), of_seed(2));
    assert!(one == of_seed(1));
    assert!(one.iter().all(|(name, bytes)| other[name] != *bytes));
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
