//! Effects that are hidden, alone and together, and what is said of them.

use std::{collections::BTreeSet, fs, path::Path};

use reality_sim::{
    Sequence,
    gap::{
        Channel, Options, Pictures,
        report::{FieldLine, Finding, MissingInput, ObjectMotion, UnobservableCause, Verdict, text::summary},
    },
    sensor::{Model, library},
};
use reality_sim_hidden::{Course, Falloff, Hidden, Recipe, Walk};

use crate::{analysed, assert_size, named, record, recorded, recording_of, reported, small};

#[test]
fn without_a_hidden_effect_nothing_is_named_and_every_effect_has_a_detection_limit_or_a_cause() {
    for seed in [1, 2] {
        let (_folder, sequence) = record(seed, &[]);
        let report = reported(&sequence);
        assert_eq!(named(&report), Vec::<&str>::new(), "seed {seed}");
        assert_eq!(report.unexplained, [], "seed {seed}");
        let told = report.not_found.len() + report.unobservable.len();
        assert_eq!(told, library().len(), "seed {seed}");
        assert_eq!(report.gap.before, report.gap.after, "seed {seed}");
    }
}

#[test]
fn a_hidden_effect_is_named_with_its_size_and_most_of_the_gap_above_the_noise_closes() {
    let pitch = Hidden::MountPitch { angle_rad: 0.02 };
    let cases: [(Hidden, &str, Channel, f64); 6] = [
        (pitch, "pitch_rad", Channel::Geometry, 0.02),
        (Hidden::TimeOffset { offset_s: 0.04 }, "offset_s", Channel::Geometry, 0.04),
        (Hidden::Defocus { sigma_px: 1.0 }, "sigma_px", Channel::Sharpness, 1.0),
        (
            Hidden::Vignetting { strength: 0.35, falloff: Falloff::Quadratic },
            "strength",
            Channel::Photometry,
            0.35,
        ),
        (
            Hidden::ChromaticAberration { red_scale: 0.003, blue_scale: -0.002 },
            "red_scale",
            Channel::Color,
            0.003,
        ),
        (Hidden::OdometryScale { scale: -0.45 }, "scale", Channel::Motion, -0.45),
    ];
    for (hidden, parameter, channel, truth) in cases {
        let (_folder, sequence) = record(11, &[hidden]);
        let report = reported(&sequence);
        assert_eq!(named(&report), [hidden.id()], "{}", summary(&report));
        assert_eq!(report.verdict, Verdict::Named, "{}", summary(&report));
        assert_size(&report, hidden.id(), parameter, truth);
        let gap = &report.gap.channels[&channel];
        let closed = (gap.before - gap.after) / (gap.before - gap.floor);
        assert!(closed > 0.5, "{}: {closed} of {gap:?}", hidden.id());
    }
}

#[test]
fn the_hidden_effect_of_a_recording_by_another_renderer_is_named_and_nothing_is_unexplained() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/pitch");
    let report = reported(&Sequence::open(&folder).unwrap());
    assert_eq!(named(&report), ["mount_pitch"], "{}", summary(&report));
    assert_eq!(report.unexplained, [], "{}", summary(&report));
    assert_eq!(report.verdict, Verdict::Named);
    let gap = &report.gap.channels[&Channel::Geometry];
    assert!(gap.before - gap.after > 0.95 * (gap.before - gap.floor), "{gap:?}");
    assert!(gap.left_out < 0.05, "{gap:?}");
}

#[test]
fn two_effects_are_both_named() {
    let effects = [Hidden::MountRoll { angle_rad: -0.025 }, Hidden::Defocus { sigma_px: 0.9 }];
    let (_folder, sequence) = record(21, &effects);
    let report = reported(&sequence);
    let found: BTreeSet<&str> = named(&report).into_iter().collect();
    assert_eq!(found, BTreeSet::from(["mount_roll", "defocus"]), "{}", summary(&report));
    assert_size(&report, "mount_roll", "roll_rad", -0.025);
}

#[test]
fn two_large_effects_that_hide_each_other_are_both_named() {
    // The gain of neither can be predicted reliably while the other is not in the model.
    let effects =
        [Hidden::RadialDistortion { k: [0.006, 0.0, 0.0, 0.0] }, Hidden::MountRoll { angle_rad: -0.019 }];
    let (_folder, sequence) = recorded(&Recipe { frames: 40, effects: effects.to_vec(), ..small(30_042) });
    let options = Options { seed: 30_042, ..Options::default() };
    let report = analysed(&sequence, &Model::default(), &options).report;
    let found: BTreeSet<&str> = named(&report).into_iter().collect();
    assert_eq!(found, BTreeSet::from(["radial_distortion", "mount_roll"]), "{}", summary(&report));
    assert_size(&report, "radial_distortion", "k1", 0.006);
    assert_size(&report, "mount_roll", "roll_rad", -0.019);
}

#[test]
fn strong_defocus_is_named_although_lines_are_spread_over_many_pixels() {
    let truth = 2.7;
    let (_folder, sequence) = record(22, &[Hidden::Defocus { sigma_px: truth }]);
    let report = reported(&sequence);
    assert_eq!(named(&report), ["defocus"], "{}", summary(&report));
    assert_size(&report, "defocus", "sigma_px", truth);
}

#[test]
fn oscillating_exposure_is_named_whichever_frames_are_held_out() {
    let course = Course::Sine { period_s: 5.0, phase_rad: 0.4 };
    let (_folder, sequence) = record(23, &[Hidden::ExposureDrift { amplitude_ev: 0.4, course }]);
    for seed in [0, 1] {
        let report = analysed(&sequence, &Model::default(), &Options { seed, ..Options::default() }).report;
        assert_eq!(named(&report), ["exposure_drift"], "seed {seed}: {}", summary(&report));
    }
}

#[test]
fn of_two_effects_that_explain_nearly_the_same_the_hidden_one_is_named() {
    let (_folder, sequence) = record(24, &[Hidden::BlackLevel { offset: 0.06 }]);
    let report = reported(&sequence);
    assert_eq!(named(&report), ["black_level"], "{}", summary(&report));
    assert_size(&report, "black_level", "offset", 0.06);
    // A tone curve of two parameters does to two brightnesses what a black level does.
    for effect in &report.effects {
        assert!(
            effect.confusable_with.iter().all(|other| other == "tone_curve"),
            "{:?}",
            effect.confusable_with
        );
    }
}

#[test]
fn an_effect_is_named_although_lines_are_far_from_where_the_model_predicts_them() {
    // The shift is 22 pixels in a picture 320 pixels wide: beyond the search range for lines.
    let (dx_px, dy_px) = (-15.0, 16.0);
    let (_folder, sequence) = record(23, &[Hidden::PrincipalPoint { dx_px, dy_px }]);
    let report = reported(&sequence);
    assert_eq!(named(&report), ["principal_point"], "{}", summary(&report));
    assert_eq!(report.verdict, Verdict::Named, "{}", summary(&report));
    assert_size(&report, "principal_point", "x_px", dx_px);
    assert_size(&report, "principal_point", "y_px", dy_px);
}

#[test]
fn people_who_walk_are_listed_as_moving_and_are_neither_an_effect_nor_unknown() {
    let (_folder, sequence) = record(47, &[Hidden::MovingPeople { count: 6 }]);
    let report = reported(&sequence);
    assert_eq!(report.verdict, Verdict::None, "{}", summary(&report));
    assert_eq!(named(&report), Vec::<&str>::new());
    let walker = report.objects.iter().find(|object| object.motion == ObjectMotion::Moving);
    assert!(walker.is_some_and(|walker| walker.share > 0.0 && walker.pictures > 0.1), "{:?}", report.objects);
}

#[test]
fn an_extended_model_given_again_has_nothing_further_to_find() {
    let (_folder, sequence) = record(31, &[Hidden::CameraHeight { height_m: 0.02 }]);
    let first = analysed(&sequence, &Model::default(), &Options::default());
    assert_eq!(named(&first.report), ["camera_height"]);
    let again = Model::from_toml(Path::new("model.toml"), &first.model.to_toml()).unwrap();
    assert_eq!(again, first.model);
    let second = analysed(&sequence, &again, &Options::default()).report;
    assert_eq!(named(&second), Vec::<&str>::new());
    assert_eq!(
        second.in_model.iter().map(|effect| effect.id.as_str()).collect::<Vec<_>>(),
        ["camera_height"]
    );
    // The measurements that either model explains are not exactly the same ones.
    assert!((second.gap.before - first.report.gap.after).abs() < 0.02 * first.report.gap.after);
}

#[test]
fn missing_lines_are_called_unknown_and_located() {
    let (_folder, sequence) =
        record(45, &[Hidden::MissingLine { positive_x: true }, Hidden::MissingLine { positive_x: false }]);
    let report = reported(&sequence);
    assert_eq!(report.verdict, Verdict::Unknown, "{}", summary(&report));
    assert_eq!(named(&report), Vec::<&str>::new());
    let found = &report.unexplained;
    assert!(found.iter().all(|finding| finding.channel() == Channel::Geometry), "{found:?}");
    let missing: Vec<&FieldLine> = found
        .iter()
        .filter_map(|finding| match finding {
            Finding::MissingLine { line, .. } => Some(line),
            _ => None,
        })
        .collect();
    // Only lines of the two goal areas are missing.
    let field = &sequence.field;
    let is_of_goal_area = |[x, y]: &[f64; 2]| {
        x.abs() > 0.5 * field.length_m - field.goal_area_length_m - 1e-6
            && y.abs() < 0.5 * field.goal_area_width_m + 1e-6
    };
    let is_hidden = |line: &&FieldLine| match line {
        FieldLine::Segment { from_m, to_m } => is_of_goal_area(from_m) && is_of_goal_area(to_m),
        FieldLine::Circle { .. } => false,
    };
    assert!(!missing.is_empty() && missing.iter().all(is_hidden), "{found:?}");
}

#[test]
fn an_effect_that_is_not_in_the_library_is_called_unknown_in_the_channel_that_it_changes() {
    let cases: [(Hidden, Channel); 4] = [
        (
            Hidden::ExposureDrift {
                amplitude_ev: 0.4,
                course: Course::Sine { period_s: 5.0, phase_rad: 0.4 },
            },
            Channel::Photometry,
        ),
        (Hidden::OdometryScale { scale: -0.3 }, Channel::Motion),
        (Hidden::SensorNoise { factor: 1.5 }, Channel::Noise),
        (Hidden::MotionBlur { exposure_s: 0.08 }, Channel::Sharpness),
    ];
    for (hidden, channel) in cases {
        let (_folder, sequence) = record(51, &[hidden]);
        let options = Options { without: vec![hidden.id().to_owned()], ..Options::default() };
        let report = analysed(&sequence, &Model::default(), &options).report;
        assert_eq!(report.verdict, Verdict::Unknown, "{}: {}", hidden.id(), summary(&report));
        let seen = report.unexplained.iter().any(|finding| finding.channel() == channel);
        assert!(seen, "{}: {:?}", hidden.id(), report.unexplained);
    }
}

#[test]
fn a_robot_that_stands_still_cannot_show_effects_of_motion() {
    let (_folder, sequence) = recorded(&Recipe {
        walk: Walk::Standing,
        effects: vec![Hidden::RollingShutter { readout_s: 0.03 }],
        ..small(61)
    });
    let report = reported(&sequence);
    assert_eq!(report.verdict, Verdict::Inconclusive, "{}", summary(&report));
    let cause =
        |id: &str| report.unobservable.iter().find(|effect| effect.id == id).map(|effect| effect.cause);
    for id in ["rolling_shutter", "time_offset", "motion_blur"] {
        assert_eq!(cause(id), Some(UnobservableCause::CameraAtRest), "{id}");
    }
    assert_eq!(cause("odometry_scale"), Some(UnobservableCause::RobotAtRest));
}

#[test]
fn the_same_seed_gives_the_same_report() {
    let (_folder, sequence) = record(71, &[Hidden::FocalLength { scale: 0.02 }]);
    let once = analysed(&sequence, &Model::default(), &Options::default());
    let twice = analysed(&sequence, &Model::default(), &Options::default());
    assert_eq!(once, twice);
    assert_eq!(named(&once.report), ["focal_length"]);
}

#[test]
fn differences_are_shown_where_the_recorded_picture_has_the_field() {
    let (_folder, sequence) = record(3, &[]);
    let model = Model::default();
    let analysis = analysed(&sequence, &model, &Options::default());
    let Pictures { measured, field, .. } =
        Pictures::new(&recording_of(&sequence), &model, &analysis).unwrap();
    // The carpet is the only green thing in the hall.
    let green = |shown: u8| {
        let shown = measured.pixels().zip(field.pixels()).filter(|(_, mask)| mask.0[0] == shown);
        let is_green: Vec<bool> =
            shown.map(|(pixel, _)| pixel.0[1] > pixel.0[0].max(pixel.0[2]) + 15).collect();
        is_green.iter().filter(|green| **green).count() as f64 / is_green.len() as f64
    };
    assert!(green(u8::MAX) > 0.85, "{} of the field", green(u8::MAX));
    assert!(green(0) < 0.05, "{} of all else", green(0));
}

#[test]
fn effects_that_need_an_input_missing_from_the_camera_file_are_unobservable() {
    let (folder, _sequence) = record(111, &[]);
    let camera = folder.path().join("camera.toml");
    let without: String = fs::read_to_string(&camera)
        .unwrap()
        .lines()
        .take_while(|line| !line.starts_with("[photometry]"))
        .flat_map(|line| [line, "\n"])
        .collect();
    fs::write(&camera, without).unwrap();
    let sequence = Sequence::open(folder.path()).unwrap();
    let report = reported(&sequence);
    let missing = [
        ("white_balance", MissingInput::Reflectance),
        ("defocus", MissingInput::Sharpness),
        ("sensor_noise", MissingInput::Noise),
    ];
    for (id, input) in missing {
        let unseen = report.unobservable.iter().find(|effect| effect.id == id);
        let cause = unseen.map(|effect| effect.cause);
        assert_eq!(cause, Some(UnobservableCause::MissingInput { input }), "{id}");
    }
    assert_eq!(named(&report), Vec::<&str>::new());
    // The first sentence says that these are not judged.
    assert_eq!(report.verdict, Verdict::None);
    for (id, _) in missing {
        assert!(report.not_judged().any(|not_judged| not_judged == id), "{id}");
    }
    assert!(
        summary(&report).starts_with("Nothing is missing among what can be judged; "),
        "{}",
        summary(&report)
    );
    // Vignetting shows in how one place looks at another radius.
    assert!(report.not_found.iter().any(|effect| effect.id == "vignetting"), "{:?}", report.unobservable);
    // A given effect is not estimated either: it stays as it is.
    let white_balance = reality_sim::sensor::effect("white_balance").unwrap();
    let given = Model::default().with(white_balance, [0.1, 0.05]);
    let extended = analysed(&sequence, &given, &Options::default()).model;
    assert_eq!(extended.values("white_balance"), given.values("white_balance"));
}

#[test]
fn a_loss_of_light_at_the_corners_is_named_without_any_nominal_photometry() {
    let hidden = Hidden::Vignetting { strength: 0.5, falloff: Falloff::Quadratic };
    let (_folder, mut sequence) = record(112, &[hidden]);
    sequence.setup.photometry = None;
    let report = reported(&sequence);
    assert_eq!(named(&report), ["vignetting"], "{}", summary(&report));
    assert_size(&report, "vignetting", "strength", 0.5);
    let gap = &report.gap.channels[&Channel::Photometry];
    assert!(gap.after < gap.before, "{gap:?}");
}

#[test]
fn noise_is_named_although_its_two_numbers_cannot_be_told_apart() {
    let (_folder, sequence) = record(26, &[Hidden::SensorNoise { factor: 1.5 }]);
    let report = reported(&sequence);
    assert_eq!(named(&report), ["sensor_noise"], "{}", summary(&report));
}
