//! Tests of the decisions of `ModelSearch`.

use reality_sim_sensor::{Effect, EffectIndex, Model};

use super::{FRAMES, Signature, World, effect};
use crate::{
    frame_index::{FrameIndex, PerFrame},
    inference::{
        held_out::Comparison, linearized_recording::LinearizedRecording, model_search::ModelSearch,
        recording_source::Linearize, split::HeldOutSplit,
    },
    linear_model::{linearization::MeasureError, linearized_frame::LinearizedFrame},
};

impl Linearize for World {
    fn linearize(&self, model: Model) -> Result<LinearizedRecording, MeasureError> {
        let frames = self.frames(&model);
        let training: Vec<&LinearizedFrame> = split().training().map(|frame| &frames[frame]).collect();
        let system = self.system(&training);
        Ok(LinearizedRecording {
            model,
            measurements: PerFrame::from(Vec::new()),
            nuisances: Vec::new(),
            frames,
            system,
        })
    }

    fn compare(&self, model: &Model, with: &LinearizedRecording) -> Result<Comparison, MeasureError> {
        Ok(Comparison::new([&self.frames(model), &self.frames(&with.model)], |_| 0.0, with, &split()))
    }

    fn starting_values(&self, effect: &'static dyn Effect) -> Vec<f64> {
        effect.parameters().iter().map(|parameter| parameter.neutral).collect()
    }
}

fn split() -> HeldOutSplit {
    HeldOutSplit::new(FRAMES, 0)
}

/// Runs a check on a search in a simulated recording, starting from the converged fit of some effects.
fn with_search<T>(
    world: &World,
    given: &[EffectIndex],
    named: &[EffectIndex],
    check: impl FnOnce(&ModelSearch<'_>, &LinearizedRecording) -> T,
) -> T {
    let split = split();
    let search = ModelSearch {
        source: world,
        columns: &world.columns,
        split: &split,
        given,
        progress: &|_| (),
        settles_ties: true,
    };
    let all: Vec<EffectIndex> = given.iter().chain(named).copied().collect();
    let linearized = search.converge(world.linearize(Model::default()).unwrap(), &all).unwrap();
    check(&search, &linearized)
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
fn a_fit_converges_to_the_true_values() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, SECOND, -4.0)]);
    let both = [PITCH, ROLL].map(effect);
    with_search(&world, &[], &both, |_, linearized| {
        for (column, truth) in world.columns.iter().zip([3.0, -4.0]) {
            let size = linearized.model.values(column.effect().id()).unwrap()[column.parameter]
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
        with_search(&world, &[], named, |search, linearized| {
            let tests = linearized.effect_tests(&world.columns);
            search
                .without_unsupported(linearized, &tests, named)
                .unwrap()
                .map(|(set, converged)| (set, converged.model))
        })
    };
    let (set, model) = dropped(&[pitch, roll]).unwrap();
    assert_eq!(set, [pitch]);
    assert!(model.values(ROLL).is_none() && model.values(PITCH).is_some());
    assert!(dropped(&[pitch]).is_none());
}

#[test]
fn a_replacement_is_tried_where_another_effect_is_better_and_an_addition_otherwise() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, PARTLY_FIRST, 0.0), ("camera_height", SECOND, 3.0)]);
    let [pitch, roll, height] = [PITCH, ROLL, "camera_height"].map(effect);
    let next = |named: &[EffectIndex], tried: &[Vec<EffectIndex>]| {
        with_search(&world, &[], named, |search, linearized| {
            let tests = linearized.effect_tests(&world.columns);
            search.next_sets(&tests, named, |set| !tried.contains(&set.to_vec()))
        })
    };
    assert_eq!(next(&[roll], &[]), [[pitch]]);
    assert_eq!(next(&[roll], &[vec![pitch]])[0].len(), 2, "a replacement that was tried is not tried again");
    assert_eq!(next(&[pitch], &[]), [[pitch, height]]);
    assert_eq!(next(&[pitch, height], &[]), Vec::<Vec<EffectIndex>>::new());
}

#[test]
fn among_sets_that_fit_equally_well_the_one_with_the_fewest_sizes_is_the_best_and_the_others_tie() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, LIKE_FIRST, 0.0), ("camera_height", SECOND, 0.0)]);
    let [pitch, roll, height] = [PITCH, ROLL, "camera_height"].map(effect);
    with_search(&world, &[], &[], |search, linearized| {
        let best = |sets_: Vec<Vec<EffectIndex>>| sets(search.best_sets(linearized, sets_).unwrap());
        let found = best(vec![vec![pitch, height], vec![roll], vec![height]]);
        assert_eq!(found, [vec![roll], vec![pitch, height]]);
        assert_eq!(best(vec![vec![height]]), [vec![height]], "a single set is the best one");
    });
}

#[test]
fn a_set_that_fits_worse_than_another_does_not_tie_with_it() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, PARTLY_FIRST, 0.0)]);
    let [pitch, roll] = [PITCH, ROLL].map(effect);
    with_search(&world, &[], &[], |search, linearized| {
        assert_eq!(sets(search.best_sets(linearized, vec![vec![roll], vec![pitch]]).unwrap()), [[pitch]]);
    });
}

#[test]
fn effects_are_confusable_if_their_converged_fits_are_equally_good() {
    let [pitch, roll] = [PITCH, ROLL].map(effect);
    let alike = World::new(&[(PITCH, FIRST, 3.0), (ROLL, LIKE_FIRST, 0.0)]);
    with_search(&alike, &[], &[pitch], |search, linearized| {
        assert_eq!(search.confusable(linearized, &[pitch], &[]).unwrap(), [(pitch, roll)]);
    });
    let apart = World::new(&[(PITCH, FIRST, 3.0), (ROLL, PARTLY_FIRST, 0.0)]);
    with_search(&apart, &[], &[pitch], |search, linearized| {
        assert_eq!(search.confusable(linearized, &[pitch], &[]).unwrap(), []);
        assert_eq!(
            search.confusable(linearized, &[pitch], &[(pitch, roll)]).unwrap(),
            [],
            "a tie in the linearised model is decided by the converged fit"
        );
    });
}

#[test]
fn a_given_parameter_that_the_frames_do_not_constrain_keeps_its_value() {
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
        settles_ties: true,
    };
    let model = Model::default().with(pitch.effect(), vec![0.05]);
    let converged = search.converge(world.linearize(model).unwrap(), &[pitch, roll]).unwrap();
    assert_eq!(converged.model.values(PITCH), Some(&[0.05][..]));
    assert!(converged.model.values(ROLL).unwrap()[0] > 0.0);
}

/// Whether a frame is held out by [`split`].
fn is_held_out(frame: usize) -> bool {
    split().held_out().any(|held_out| FrameIndex::first(FRAMES).nth(frame) == Some(held_out))
}

/// Returns what is left of these named effects once held-out frames have been asked.
fn confirmed(world: &World, named: &[EffectIndex]) -> (Vec<EffectIndex>, Model) {
    with_search(world, &[], named, |search, linearized| {
        let (named, linearized) =
            search.confirmed(&Model::default(), (named.to_vec(), linearized.clone())).unwrap();
        (named, linearized.model)
    })
}

#[test]
fn held_out_frames_confirm_effects_that_are_there() {
    let world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, SECOND, -4.0)]);
    let both = [PITCH, ROLL].map(effect);
    assert_eq!(confirmed(&world, &both).0, both);
}

#[test]
fn an_effect_that_held_out_frames_contradict_is_dropped_and_the_others_are_fitted_without_it() {
    // What is seen of the second effect in the training frames is the opposite in the others.
    let mut world = World::new(&[(PITCH, FIRST, 3.0), (ROLL, SECOND, 2.0)]);
    world.course = |frame, column| if column == 1 && is_held_out(frame) { -1.0 } else { 1.0 };
    let [pitch, roll] = [PITCH, ROLL].map(effect);
    let (named, model) = confirmed(&world, &[pitch, roll]);
    assert_eq!(named, [pitch]);
    assert!(model.values(ROLL).is_none());
    let alone = with_search(&world, &[], &[pitch], |_, linearized| linearized.model.clone());
    let size = |model: &Model| model.values(PITCH).unwrap()[0];
    assert!((size(&model) / size(&alone) - 1.0).abs() < 0.01, "{} {}", size(&model), size(&alone));
}

#[test]
fn chance_is_seldom_confirmed() {
    let kept = (0..40).filter(|&seed| {
        let mut world = World::new(&[(PITCH, FIRST, 0.0)]);
        world.seed = seed;
        !confirmed(&world, &[effect(PITCH)]).0.is_empty()
    });
    let kept = kept.count();
    assert!(kept < 20, "{kept} of 40");
}
