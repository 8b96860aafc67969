//! Wording of the effects, sizes, names and limits over the whole library, compared with `words.txt`. `PINNED=write cargo test
//! --test words` writes that file anew; review the difference before it is committed.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    collections::BTreeSet,
    env,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};

use reality_sim_core::pose::CameraPose;
use reality_sim_sensor::{
    Changes, Effect, Estimates, Need, Parameter, Role, Stage, effect, library,
    text::{Uncertain, Unit},
};

type Values = Vec<(&'static str, Uncertain)>;

/// Made-up estimates of one effect.
struct Case {
    label: String,
    values: Values,
    correlation: f64,
}

fn fitted(effect: &dyn Effect) -> Vec<&'static Parameter> {
    effect.parameters().iter().filter(|parameter| parameter.role != Role::Fixed).collect()
}

/// Returns large values with alternating signs; those selected by `stands_out` have small errors.
fn made_up(effect: &dyn Effect, signs: [f64; 2], stands_out: impl Fn(&str) -> bool) -> Values {
    let value = |(index, parameter): (usize, &Parameter)| {
        let end = parameter.range[usize::from(signs[index % 2] > 0.0)];
        let value = (0.31 + 0.07 * (index % 4) as f64) * end;
        let part = if stands_out(parameter.name) { 0.053 } else { 0.83 };
        (parameter.name, Uncertain { value, sigma: value.abs() * part })
    };
    fitted(effect).into_iter().enumerate().map(value).collect()
}

/// Cases with positive, negative and mixed values: all significant, one, none; without errors; unknown; none at all.
fn cases(effect: &dyn Effect) -> Vec<Case> {
    let mut cases = Vec::new();
    for (sign_name, signs) in [("+", [1.0, 1.0]), ("-", [-1.0, -1.0]), ("+-", [1.0, -1.0])] {
        let mut case = |label: &str, values| {
            cases.push(Case { label: format!("{sign_name} {label}"), values, correlation: -0.9 });
        };
        case("all", made_up(effect, signs, |_| true));
        for parameter in fitted(effect) {
            case(parameter.name, made_up(effect, signs, |name| name == parameter.name));
        }
        case("none", made_up(effect, signs, |_| false));
    }
    let with = |change: fn(f64) -> Uncertain| -> Values {
        cases[0].values.iter().map(|(name, estimate)| (*name, change(estimate.value))).collect()
    };
    let exact = with(|value| Uncertain { value, sigma: 0.0 });
    let unknown = with(|_| Uncertain { value: f64::NAN, sigma: f64::NAN });
    for (label, values) in [("exact", exact), ("unknown", unknown), ("nothing", Vec::new())] {
        cases.push(Case { label: label.to_owned(), values, correlation: 0.0 });
    }
    cases
}

/// Returns everything that an effect says, a line each.
fn said(effect: &dyn Effect) -> String {
    let mut text = format!("\n{}\n", effect.id());
    for parameter in fitted(effect).into_iter().filter(|parameter| parameter.role == Role::Size) {
        let limit = effect.limit_in_words(parameter.name, 1.37 * parameter.material);
        writeln!(text, "limit: {limit}").unwrap();
    }
    let mut before = ("", "");
    for Case { label, values, correlation } in cases(effect) {
        let correlation = |_: &str, _: &str| correlation;
        let estimates = Estimates::new(&values, &correlation);
        let (name, because) = effect.name_and_signature(&estimates);
        if (name, because) != before {
            writeln!(text, "name: {name}\nbecause: {because}").unwrap();
            before = (name, because);
        }
        writeln!(text, "{label}: {}", effect.size_in_words(&estimates)).unwrap();
    }
    text
}

#[test]
fn the_wording_of_every_effect_is_the_recorded_one() {
    let mut ranked = library().to_vec();
    ranked.sort_by_key(|effect| effect.about().rank);
    let nouns = ranked.iter().map(|effect| format!("{}: {}\n", effect.id(), effect.about().noun));
    let now: String = nouns.chain(library().iter().map(|effect| said(*effect))).collect();
    if env::var_os("PINNED").is_some_and(|value| value == "write") {
        fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/words.txt"), &now).unwrap();
        return;
    }
    for (line, (now, then)) in now.lines().zip(include_str!("words.txt").lines()).enumerate() {
        assert_eq!(now, then, "line {}", line + 1);
    }
    assert_eq!(now, include_str!("words.txt"));
}

#[test]
fn what_an_effect_needs_and_changes_agrees_with_its_stage_and_its_numbers() {
    let still = CameraPose { x_m: 0.0, y_m: 0.0, yaw_rad: 0.0, height_m: 0.5, pitch_rad: 0.4, roll_rad: 0.0 };
    let mut ranks = BTreeSet::new();
    for effect in library() {
        let (id, about) = (effect.id(), effect.about());
        assert!(ranks.insert(about.rank), "{id}");
        let is_belief = matches!(about.changes, Changes::Odometry | Changes::Attitude);
        assert_eq!(is_belief, about.stage == Stage::Odometry, "{id}");
        assert_eq!(about.needs.contains(&Need::Odometry), about.changes == Changes::Odometry, "{id}");
        assert!(about.changes != Changes::Noise || about.needs.contains(&Need::NominalNoise), "{id}");
        let moves_clock = effect.clock_s(&[0.01]) != 0.0;
        assert_eq!(about.changes == Changes::PicturesAndOdometry, moves_clock, "{id}");
        let p = [0.0, 10.0, 0.1, 0.2];
        let changes = effect.gain(&p, 0.0) != effect.gain(&p, 5.0)
            || effect.picture_delay_s(&[0.1, 3.0], 0.0) != effect.picture_delay_s(&[0.1, 3.0], 5.0)
            || effect.sway(&[0.1, 0.1, 0.0, 0.0, 1.3], still, 0.0)
                != effect.sway(&[0.1, 0.1, 0.0, 0.0, 1.3], still, 5.0);
        assert_eq!(about.varies_over_time, changes, "{id}");
        for parameter in about.parameters.iter().filter(|parameter| parameter.role == Role::Size) {
            let units: &[Unit] = match parameter.unit {
                "rad" => &[Unit::Degrees],
                "rad/s" => &[Unit::DegreesPerSecond],
                "s" => &[Unit::Milliseconds],
                "m" => &[Unit::Centimeters],
                "px" => &[Unit::Pixels],
                "EV" => &[Unit::ExposureValues],
                _ => &[Unit::Percent, Unit::Plain],
            };
            assert!(units.contains(&about.unit), "{id}: {}", parameter.name);
        }
    }
}

fn size(id: &str, values: &[(&'static str, f64, f64)], correlation: f64) -> String {
    let values: Values =
        values.iter().map(|&(name, value, sigma)| (name, Uncertain { value, sigma })).collect();
    effect(id).unwrap().size_in_words(&Estimates::new(&values, &|_, _| correlation))
}

#[test]
fn noise_is_stated_at_the_brightness_where_it_is_best_known() {
    // The noise changes by 0.0004 at a light of 0.4; which part depends on the light is not known.
    let values = [("shot", 0.0005, 0.0005), ("read_variance", 0.0002, 0.0002)];
    let text = "at 40 % of full light, 2.00 % of full scale is missing (± 0.14 %)";
    assert_eq!(size("sensor_noise", &values, -0.99), text);
    let values = [("shot", 0.0009, 0.000_15), ("read_variance", -1e-7, 1e-6)];
    let text = "where it is white, 3.0 % of full scale is missing (± 0.5 %)";
    assert_eq!(size("sensor_noise", &values, 0.0), text);
}

#[test]
fn a_direction_of_bending_is_named_only_where_all_radii_agree() {
    let lens = |k1: f64, k2: f64| {
        let values = [("k1", k1, 0.002), ("k2", k2, 0.002), ("k3", 0.0, 0.001), ("k4", 0.0, 0.001)];
        size("radial_distortion", &values, 0.0)
    };
    let inwards = "k1 = −0.067 (± 0.004), which moves points far from the middle inwards";
    assert_eq!(lens(-0.067, 0.001), inwards);
    assert_eq!(lens(-0.05, 0.09), "k1 = −0.050 (± 0.004), k2 = 0.090 (± 0.004)");
}

#[test]
fn the_row_of_the_time_stamp_is_named_where_it_is_known() {
    let values = [("readout_s", 0.02, 0.000_51), ("reference_s", 0.01, 0.0005)];
    let text = "from the top to the bottom within 20 ms (± 1 ms); the time stamp is that of the top row";
    assert_eq!(size("rolling_shutter", &values, 0.0), text);
}

#[test]
fn a_drift_is_stated_from_the_darkest_moment_to_the_brightest() {
    let values =
        [("from_s", 5.0, 0.0), ("ev_01", -0.3, 0.01), ("ev_02", 0.5, 0.01), ("ev_03", f64::NAN, 0.0)];
    let text = "the brightest moment has 74 % more light than the darkest, 0.800 EV (± 0.028 EV)";
    assert_eq!(size("exposure_drift", &values, 0.0), text);
}

#[test]
fn uneven_light_has_a_brightest_and_a_darkest_place() {
    let names = ["x", "y", "xx", "xy", "yy"];
    let factors = [0.3, 0.0, 0.0, 0.0, -0.2];
    let values: Vec<_> = names.into_iter().zip(factors).map(|(name, value)| (name, value, 0.01)).collect();
    let text =
        "the light is brightest at the end at +x and darkest in the corner at −x and −y, by a factor of 2.5";
    assert_eq!(size("uneven_illumination", &values, 0.0), text);
}

#[test]
fn every_effect_has_words_of_its_own() {
    for effect in library() {
        let values: Vec<_> =
            effect.parameters().iter().map(|parameter| (parameter.name, 0.01, 0.001)).collect();
        assert!(!size(effect.id(), &values, 0.0).contains(" ± 0.001"), "{}", effect.id());
    }
}

#[test]
fn estimates_that_are_not_finite_leave_no_trace_in_the_words() {
    for effect in library() {
        for (value, sigma) in [(f64::NAN, f64::NAN), (0.0, f64::NAN), (f64::INFINITY, 1.0), (0.0, 0.0)] {
            let values: Vec<_> =
                effect.parameters().iter().map(|parameter| (parameter.name, value, sigma)).collect();
            let text = size(effect.id(), &values, 0.0);
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}

/// Lists the Rust sources in a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}

/// Returns the code of a file before its tests and without comments: tests and examples may name effects.
fn code(source: &str) -> String {
    let before_tests = source.split("#[cfg(test)]").next().unwrap_or(source);
    before_tests.lines().filter(|line| !line.trim_start().starts_with("//")).collect()
}

fn is_test(path: &Path) -> bool {
    path.iter().any(|part| ["tests", "tests.rs", "testing.rs"].iter().any(|name| part == *name))
}

#[test]
fn no_source_file_but_its_own_names_an_effect() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let crates = ["sensor", "gap", "viewer", "synthesis", "db", "reality-sim"];
    let folders = crates.map(|name| workspace.join("crates").join(name).join("src"));
    // A packaged crate has no neighbours.
    let files: Vec<PathBuf> = folders
        .iter()
        .chain([&workspace.join("src")])
        .filter(|folder| folder.is_dir())
        .flat_map(|folder| sources(folder))
        .filter(|path| !is_test(path.strip_prefix(&workspace).unwrap()))
        .collect();
    for effect in library() {
        let (literal, own) = (format!("\"{}\"", effect.id()), format!("effects/{}.rs", effect.id()));
        let naming: Vec<_> =
            files.iter().filter(|path| code(&fs::read_to_string(path).unwrap()).contains(&literal)).collect();
        assert!(naming.len() == 1 && naming[0].ends_with(&own), "{literal}: {naming:?}");
    }
}
