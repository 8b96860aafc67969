//! The gap workflow in drawn worlds: other halls, lenses, carpets and robots than those of the standard one.

use reality_sim::{
    gap::{
        Options, Simplification, analyse,
        report::{Report, Verdict, text::summary},
    },
    sensor::Model,
    sequence::Trust,
};
use reality_sim_hidden::{Hidden, Recipe};

use crate::{assert_size, named, recorded, recording_of, reported};

/// Returns a drawn world of 40 frames with these effects.
fn drawn(seed: u64, effects: &[Hidden]) -> Recipe {
    Recipe { effects: effects.to_vec(), frames: 40, size: [640, 480], ..Recipe::drawn(seed) }
}

fn reported_of(recipe: &Recipe) -> Report {
    let (_folder, sequence) = recorded(recipe);
    reported(&sequence)
}

/// Asserts that the report names exactly this effect, and that its estimate is within four standard deviations of the truth.
fn assert_found(report: &Report, id: &str, parameter: &str, truth: f64) {
    assert_eq!((report.verdict, named(report)), (Verdict::Named, vec![id]), "{}", summary(report));
    assert_size(report, id, parameter, truth);
}

/// In this world the carpet is brighter by up to a tenth where the camera looks at it from another side, and the paint is not.
#[test]
fn what_the_carpet_alone_shows_is_no_drift_of_the_exposure() {
    let report = reported_of(&drawn(101_160_000, &[]));
    assert_eq!((report.verdict, report.effects.len()), (Verdict::None, 0), "{}", summary(&report));
}

/// Pictures in which the nominal camera takes other lines for those that it expects.
#[test]
fn wrong_matches_of_the_camera_as_given_do_not_count_as_scatter() {
    let report = reported_of(&drawn(101_220_000, &[Hidden::CameraYaw { angle_rad: -0.0232 }]));
    assert_found(&report, "camera_yaw", "yaw_rad", -0.0232);
}

/// The short lines of a goal area, a few pixels from where the reference poses put them.
#[test]
fn lines_that_errors_of_the_reference_poses_displace_are_not_missing() {
    let report = reported_of(&drawn(101_010_000, &[]));
    assert_eq!((report.verdict, report.effects.len()), (Verdict::None, 0), "{}", summary(&report));
}

#[test]
fn stray_light_is_told_from_a_black_level() {
    let recipe = drawn(101_280_000, &[Hidden::VeilingGlare { share: 0.15 }]);
    let report = reported_of(&Recipe { frames: 60, ..recipe });
    assert_found(&report, "veiling_glare", "share", 0.15);
}

/// A person's measurement is trusted to 5 %; one that is trusted to 50 % may be off by that much.
#[test]
fn lines_brighter_than_stated_are_named_unless_the_files_trust_their_brightness_less() {
    let (_folder, mut sequence) = recorded(&drawn(101_300_000, &[Hidden::LineReflectance { change: 0.8 }]));
    assert_found(&reported(&sequence), "line_reflectance", "change", 0.8);
    let photometry = sequence.setup.photometry.as_mut().unwrap();
    photometry.trust = Some(Trust { line: Some(0.5), ..Trust::default() });
    assert!(reported(&sequence).effects.is_empty());
}

/// A world in which nothing is hidden, of few and small pictures.
#[test]
fn simpler_workflows_see_effects_where_there_are_none() {
    let (_folder, sequence) = recorded(&Recipe { frames: 24, size: [320, 240], ..drawn(1001, &[]) });
    assert_eq!(reported(&sequence).verdict, Verdict::None);
    let simpler = |simplification| {
        let recording = recording_of(&sequence).simplified(simplification);
        analyse(&recording, &Model::default(), &Options::default(), &|_| ()).unwrap().report
    };
    for simplification in [Simplification::ExactPoses, Simplification::EvenSurfaces] {
        assert_ne!(simpler(simplification).verdict, Verdict::None, "{simplification:?}");
    }
    for simplification in [Simplification::InformationCriterion, Simplification::CrossValidation] {
        let report = simpler(simplification);
        assert!(!report.effects.is_empty(), "{simplification:?}");
        assert!(report.effects.iter().all(|effect| effect.confusable_with.is_empty()), "{simplification:?}");
    }
}
