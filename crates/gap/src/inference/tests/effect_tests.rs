//! Tests of the decisions of `EffectTests`.

use reality_sim_sensor::{EffectIndex, Model};

use super::{Signature, World, effect};
use crate::inference::{
    effect_fit::EffectFits,
    effect_test::{EffectTest, EffectTests},
    evidence::Evidence,
};

/// Runs a check on the effect tests of a simulated recording, at the model without effects.
fn with_tests<T>(world: &World, check: impl FnOnce(&EffectTests<'_>) -> T) -> T {
    let model = Model::default();
    let frames = world.frames(&model);
    let system = world.system(&frames.iter().collect::<Vec<_>>());
    let evidence = Evidence::new(&system, world.base(&model));
    check(&EffectTests::new(EffectFits { evidence, columns: &world.columns }))
}

fn test_of(world: &World, id: &str) -> EffectTest {
    with_tests(world, |tests| tests.test(effect(id), &[], world.columns.len()).unwrap())
}

const FIRST: Signature = |_, numbers| numbers[0];
const SECOND: Signature = |_, numbers| numbers[1];
const THIRD: Signature = |_, numbers| numbers[2];
/// Signature almost equal to [`FIRST`].
const LIKE_FIRST: Signature = |_, numbers| numbers[0] + 0.05 * numbers[3];
/// Signature partly correlated with [`FIRST`].
const PARTLY_FIRST: Signature = |_, numbers| 0.8 * numbers[0] + 0.6 * numbers[3];

#[test]
fn a_large_effect_is_supported_and_an_absent_one_is_not() {
    let world = World::new(&[("mount_pitch", FIRST, 3.0), ("mount_roll", SECOND, 0.0)]);
    let pitch = test_of(&world, "mount_pitch");
    assert!(pitch.is_supported() && pitch.material && pitch.p_value < 1e-6, "{pitch:?}");
    let roll = test_of(&world, "mount_roll");
    assert!(!roll.is_supported() && roll.p_value > 0.05, "{roll:?}");
}

#[test]
fn a_significant_effect_below_its_material_size_is_not_supported() {
    let world = World::new(&[("mount_pitch", FIRST, 0.7), ("mount_roll", SECOND, 0.0)]);
    let pitch = test_of(&world, "mount_pitch");
    assert!(pitch.p_value < 1e-4 && pitch.gain.value > 4.0, "{pitch:?}");
    assert!(!pitch.material && !pitch.is_supported());
}

#[test]
fn an_effect_whose_size_would_have_to_be_negative_is_not_supported() {
    let blur = |size: f64| {
        test_of(&World::new(&[("motion_blur", FIRST, size), ("mount_roll", SECOND, 0.0)]), "motion_blur")
    };
    assert!(blur(2.0).is_supported());
    assert!(blur(-2.0).p_value == 1.0 && !blur(-2.0).is_supported());
}

#[test]
fn p_values_are_corrected_for_the_number_of_effects_tested() {
    let world = World::new(&[("mount_pitch", FIRST, 0.3), ("mount_roll", SECOND, 0.0)]);
    with_tests(&world, |tests| {
        let p_value = |tested: usize| tests.test(effect("mount_pitch"), &[], tested).unwrap().p_value;
        assert!((p_value(20) / p_value(1) - 20.0).abs() < 1e-9);
    });
}

fn additions(world: &World, named: &[&str]) -> Vec<Vec<EffectIndex>> {
    let named: Vec<EffectIndex> = named.iter().map(|id| effect(id)).collect();
    with_tests(world, |tests| tests.next_additions(&named, |_| true))
}

#[test]
fn an_effect_that_was_tried_leaves_its_place_to_the_next() {
    let world = World::new(&[("mount_pitch", FIRST, 2.5), ("mount_roll", SECOND, 4.0)]);
    let roll = effect("mount_roll");
    let sets = with_tests(&world, |tests| tests.next_additions(&[], |added| added != [roll]));
    assert_eq!(sets, [[effect("mount_pitch")]]);
    let sets = with_tests(&world, |tests| tests.next_additions(&[], |_| false));
    assert!(sets.is_empty(), "{sets:?}");
}

#[test]
fn the_effect_of_the_largest_gain_is_added_first_and_nothing_where_none_is_supported() {
    let effects = [("mount_pitch", FIRST, 2.5), ("mount_roll", SECOND, 4.0), ("camera_height", THIRD, 0.0)];
    let world = World::new(&effects);
    assert_eq!(additions(&world, &[]), [[effect("mount_roll")]]);
    assert_eq!(additions(&world, &["mount_roll"]), [[effect("mount_pitch")]]);
    assert_eq!(additions(&world, &["mount_roll", "mount_pitch"]), Vec::<Vec<EffectIndex>>::new());
}

#[test]
fn an_effect_beside_which_the_best_one_adds_nothing_is_an_alternative() {
    let world = World::new(&[("mount_pitch", FIRST, 3.0), ("mount_roll", LIKE_FIRST, 0.0)]);
    assert_eq!(additions(&world, &[]), [[effect("mount_pitch")], [effect("mount_roll")]]);
    let world = World::new(&[("mount_pitch", FIRST, 3.0), ("mount_roll", PARTLY_FIRST, 0.0)]);
    assert_eq!(additions(&world, &[]), [[effect("mount_pitch")]]);
}

/// Signature that agrees with [`HIDES`] in one stretch of the recording and opposes it in the next. While either effect is
/// missing from the model, the next stretch contradicts what one stretch shows of the other.
const TURNS: Signature = |_, numbers| numbers[0];
const HIDES: Signature = |frame, numbers| {
    let sign = if frame / 10 % 2 == 0 { 1.0 } else { -1.0 };
    sign * numbers[0] + 0.1 * numbers[1]
};

#[test]
fn two_effects_that_hide_each_other_are_added_together() {
    for size in [2.0, 3.0] {
        let world = World::new(&[("mount_pitch", TURNS, size), ("mount_roll", HIDES, size)]);
        for id in ["mount_pitch", "mount_roll"] {
            assert!(!test_of(&world, id).is_supported(), "{id} {size}");
        }
        assert_eq!(additions(&world, &[]), [["mount_pitch", "mount_roll"].map(effect)]);
    }
}

#[test]
fn a_named_effect_is_replaced_by_one_that_explains_clearly_more() {
    let world = World::new(&[("mount_pitch", FIRST, 3.0), ("mount_roll", PARTLY_FIRST, 0.0)]);
    let [pitch, roll] = ["mount_pitch", "mount_roll"].map(effect);
    with_tests(&world, |tests| {
        assert_eq!(tests.replacements(&[roll], &[roll]), [(roll, pitch)]);
        assert_eq!(tests.replacements(&[pitch], &[pitch]), []);
    });
}

#[test]
fn effects_that_gain_as_much_in_the_place_of_a_named_one_are_confusable_with_it() {
    let [pitch, roll, height] = ["mount_pitch", "mount_roll", "camera_height"].map(effect);
    let effects =
        [("mount_pitch", FIRST, 3.0), ("mount_roll", LIKE_FIRST, 0.0), ("camera_height", THIRD, 2.0)];
    with_tests(&World::new(&effects), |tests| {
        assert_eq!(tests.confusable_with(pitch, &[pitch, height]), [roll]);
        assert_eq!(tests.confusable_with(height, &[pitch, height]), []);
    });
    let apart = [("mount_pitch", FIRST, 3.0), ("mount_roll", PARTLY_FIRST, 0.0)];
    with_tests(&World::new(&apart), |tests| assert_eq!(tests.confusable_with(pitch, &[pitch]), []));
}

#[test]
fn a_fit_holds_a_parameter_at_the_end_of_its_range_and_refits_the_others() {
    let mut world = World::new(&[("motion_blur", FIRST, -2.0), ("mount_roll", LIKE_FIRST, 2.0)]);
    world.seed = 5;
    let both = ["motion_blur", "mount_roll"].map(effect);
    with_tests(&world, |tests| {
        let fit = tests.fits.fit_in_range(&both).unwrap();
        assert_eq!(fit.delta[0], 0.0);
        let alone = tests.fits.fit_in_range(&both[1..]).unwrap();
        assert!((fit.delta[1] - alone.delta[1]).abs() < 1e-9);
    });
}
