//! Tests of the decisions of `ModelSearch`.

use reality_sim_sensor::{Effect, EffectIndex, Model};

use super::{FRAMES, Signature, World, effect};
use crate::{
    inference::{
        linearized_recording::{Linearize, LinearizedRecording},
        model_search::ModelSearch,
        split::HeldOutSplit,
    },
    linear_model::{linearization::MeasureError, linearized_frame::LinearizedFrame},
};

impl Linearize for World {
    fn linearize(&self, model: Model) -> Result<LinearizedRecording, MeasureError> {
        let frames = self.frames(&model);
        let fitted: Vec<&LinearizedFrame> = split().fitted().map(|frame| &frames[frame]).collect();
        let system = self.system(&fitted);
        Ok(LinearizedRecording { model, looks: Vec::new(), tolerances: Vec::new(), frames, system })
    }

    fn starting_values(&self, effect: &'static dyn Effect) -> Vec<f64> {
        effect.parameters().iter().map(|parameter| parameter.neutral).collect()
    }
}

fn split() -> HeldOutSplit {
    HeldOutSplit::new(FRAMES, 0)
}

/// Runs a check on a search in a simulated recording, starting from a settled model with some effects.
fn with_search<T>(
    world: &World,
    given: &[EffectIndex],
    named: &[EffectIndex],
    check: impl FnOnce(&ModelSearch<'_>, &LinearizedRecording) -> T,
) -> T {
    let split = split();
    let search =
        ModelSearch { source: world, columns: &world.columns, split: &split, given, progress: &|_| () };
    let all: Vec<EffectIndex> = given.iter().chain(named).copied().collect();
    let measured = search.settle(world.linearize(Model::default()).unwrap(), &all).unwrap();
    check(&search, &measured)
}

const FIRST: Signature = |_, numbers| numbers[0];
const SECOND: Signature = |_, numbers| numbers[1];
const LIKE_FIRST: Signature = |_, numbers| numbers[0] + 0.02 * numbers[3];
const PARTLY_FIRST: Signature = |_, numbers| 0.8 * numbers[0] + 0.6 * numbers[3];

const PITCH: &str = "mount_pitch";
const ROLL: &str = "mount_roll";

fn sets(found: Vec<(Vec<EffectIndex>, LinearizedRecording)>) -> Vec<Vec<EffectIndex>> {
    found.into_iter().map(|(set, _)| set).collect()
}

#[test]
fn a_set_settles_at_the_true_values() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, SECOND, -4.0)]);
    let both = [PITCH, ROLL].map(effect);
    with_search(&world, &[], &both, |_, measured| {
        for (column, truth) in world.columns.iter().zip([3.0, -4.0]) {
            let size = measured.model.values(column.effect().id()).unwrap()[column.parameter]
                / column.parameter().material;
            assert!((size - truth).abs() < 0.2, "{size} for {truth}");
        }
    });
}

#[test]
fn an_effect_that_is_no_longer_supported_is_dropped_and_a_supported_one_is_kept() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, SECOND, 0.0)]);
    let [pitch, roll] = [PITCH, ROLL].map(effect);
    let dropped = |named: &[EffectIndex]| {
        with_search(&world, &[], named, |search, measured| {
            let tests = measured.effect_tests(&world.columns);
            search.dropped(measured, &tests, named).unwrap().map(|(set, settled)| (set, settled.model))
        })
    };
    let (set, model) = dropped(&[pitch, roll]).unwrap();
    assert_eq!(set, [pitch]);
    assert!(model.values(ROLL).is_none() && model.values(PITCH).is_some());
    assert!(dropped(&[pitch]).is_none());
}

#[test]
fn next_sets_are_a_swap_where_another_effect_is_better_else_one_more() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, PARTLY_FIRST, 0.0), ("camera_height", SECOND, 3.0)]);
    let [pitch, roll, height] = [PITCH, ROLL, "camera_height"].map(effect);
    let next = |named: &[EffectIndex], tried: &[Vec<EffectIndex>]| {
        with_search(&world, &[], named, |search, measured| {
            let tests = measured.effect_tests(&world.columns);
            search.next_sets(&tests, named, |set| !tried.contains(&set.to_vec()))
        })
    };
    assert_eq!(next(&[roll], &[]), [[pitch]]);
    assert_eq!(next(&[roll], &[vec![pitch]])[0].len(), 2, "a swap that was tried is not tried again");
    assert_eq!(next(&[pitch], &[]), [[pitch, height]]);
    assert_eq!(next(&[pitch, height], &[]), Vec::<Vec<EffectIndex>>::new());
}

#[test]
fn of_sets_that_leave_as_little_the_one_of_fewest_sizes_is_taken_and_the_others_tie() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, LIKE_FIRST, 0.0), ("camera_height", SECOND, 0.0)]);
    let [pitch, roll, height] = [PITCH, ROLL, "camera_height"].map(effect);
    with_search(&world, &[], &[], |search, measured| {
        let closest = |sets_: Vec<Vec<EffectIndex>>| sets(search.closest(measured, sets_).unwrap());
        let found = closest(vec![vec![pitch, height], vec![roll], vec![height]]);
        assert_eq!(found, [vec![roll], vec![pitch, height]]);
        assert_eq!(closest(vec![vec![height]]), [vec![height]], "a single set is taken as it is");
    });
}

#[test]
fn a_set_that_leaves_more_than_another_does_not_tie_with_it() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, PARTLY_FIRST, 0.0)]);
    let [pitch, roll] = [PITCH, ROLL].map(effect);
    with_search(&world, &[], &[], |search, measured| {
        assert_eq!(sets(search.closest(measured, vec![vec![roll], vec![pitch]]).unwrap()), [[pitch]]);
    });
}

#[test]
fn effects_are_confusable_where_either_leaves_as_little_once_it_has_settled() {
    let [pitch, roll] = [PITCH, ROLL].map(effect);
    let alike = World::new(&[(PITCH, FIRST, 3.0), (ROLL, LIKE_FIRST, 0.0)]);
    with_search(&alike, &[], &[pitch], |search, measured| {
        assert_eq!(search.confusable(measured, &[pitch], &[]).unwrap(), [(pitch, roll)]);
    });
    let apart = World::new(&[(PITCH, FIRST, 3.0), (ROLL, PARTLY_FIRST, 0.0)]);
    with_search(&apart, &[], &[pitch], |search, measured| {
        assert_eq!(search.confusable(measured, &[pitch], &[]).unwrap(), []);
        assert_eq!(search.confusable(measured, &[pitch], &[(pitch, roll)]).unwrap(), [], "a tie is settled");
    });
}

#[test]
fn what_these_frames_do_not_tell_of_a_given_effect_stays_as_it_was_given() {
    let world = World::new(&[(PITCH, |_, _| 0.0, 0.0), (ROLL, SECOND, 3.0)]);
    let [pitch, roll] = [PITCH, ROLL].map(effect);
    let split = split();
    let given = [pitch];
    let search = ModelSearch {
        source: &world,
        columns: &world.columns,
        split: &split,
        given: &given,
        progress: &|_| (),
    };
    let model = Model::default().with(pitch.effect(), vec![0.05]);
    let settled = search.settle(world.linearize(model).unwrap(), &[pitch, roll]).unwrap();
    assert_eq!(settled.model.values(PITCH), Some(&[0.05][..]));
    assert!(settled.model.values(ROLL).unwrap()[0] > 0.0);
}
