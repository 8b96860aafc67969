//! Search for the set of effects that a recording supports: which set to try next, and how a set settles, that is, is fitted
//! while everything is measured anew where the model puts things.

use std::cmp::Ordering;

use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    inference::effect_test::{EffectTest, EffectTests},
    inference::linearized_recording::{Linearize, LinearizedRecording},
    inference::model_comparison::{indistinguishable_below, minus_log_likelihood},
    inference::split::HeldOutSplit,
    linear_model::column::ColumnIndex,
    linear_model::linearization::MeasureError,
    linear_model::parameters::FittedParameter,
    linear_model::reduced_equations::Fit,
    linear_model::system::LinearSystem,
    thresholds::{InferenceThresholds, Thresholds},
    workflow::progress::Progress,
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// Search among the sets of effects of one recording.
pub(crate) struct ModelSearch<'a> {
    pub(crate) source: &'a dyn Linearize,
    pub(crate) columns: &'a [FittedParameter],
    pub(crate) split: &'a HeldOutSplit,
    /// Effects that the model has had from the start.
    pub(crate) given: &'a [EffectIndex],
    pub(crate) progress: &'a dyn Fn(Progress),
}

/// A set of named effects, and the recording at the model in which they are settled.
pub(crate) type Settled = (Vec<EffectIndex>, LinearizedRecording);

impl ModelSearch<'_> {
    /// The effects of a model in which these are named.
    fn all(&self, named: &[EffectIndex]) -> Vec<EffectIndex> {
        self.given.iter().chain(named).copied().collect()
    }

    /// The model without an effect that is no longer supported, settled, where the effect is not supported beside that model,
    /// either: once settled, a large effect may seem unsupported, as Wald's test loses its power far from zero (Hauck and
    /// Donner 1977). `tests` are those of `measured`.
    pub(crate) fn dropped(
        &self,
        measured: &LinearizedRecording,
        tests: &EffectTests<'_>,
        named: &[EffectIndex],
    ) -> Result<Option<Settled>, MeasureError> {
        let all = self.all(named);
        let tested = tests.effects().len();
        let is_supported = |tests: &EffectTests<'_>, effect: EffectIndex, beside: &[EffectIndex]| {
            tests.test(effect, beside, tested).as_ref().is_some_and(EffectTest::is_supported)
        };
        for &fallen in named.iter().filter(|effect| !is_supported(tests, **effect, &all)) {
            let others: Vec<EffectIndex> = named.iter().copied().filter(|effect| *effect != fallen).collect();
            let without = self.all(&others);
            let settled = self.settle(measured.clone(), &without)?;
            if !is_supported(&settled.effect_tests(self.columns), fallen, &without) {
                return Ok(Some((others, settled)));
            }
        }
        Ok(None)
    }

    /// P-value of an effect that is not in the model, corrected for all effects of the library.
    pub(crate) fn p_value(
        &self,
        tests: &EffectTests<'_>,
        named: &[EffectIndex],
        effect: EffectIndex,
    ) -> Option<f64> {
        Some(tests.test(effect, &self.all(named), tests.effects().len())?.p_value)
    }

    /// The next sets of named effects to try, one of which is to be taken: one effect replaced by a better one, one more, or
    /// two more. `is_new` is true for sets that were not tried yet.
    pub(crate) fn next_sets(
        &self,
        tests: &EffectTests<'_>,
        named: &[EffectIndex],
        is_new: impl Fn(&[EffectIndex]) -> bool,
    ) -> Vec<Vec<EffectIndex>> {
        let all = self.all(named);
        let swapped = |(old, new): (EffectIndex, EffectIndex)| -> Vec<EffectIndex> {
            named.iter().map(|&effect| if effect == old { new } else { effect }).collect()
        };
        if let Some(swap) = tests.replacements(&all, named).into_iter().map(swapped).find(|set| is_new(set)) {
            return vec![swap];
        }
        let with =
            |added: &[EffectIndex]| -> Vec<EffectIndex> { named.iter().chain(added).copied().collect() };
        tests.next_additions(&all).iter().map(|added| with(added)).filter(|set| is_new(set)).collect()
    }

    /// Settles each of several sets: first the one to take, then those that leave as little. The one to take has the fewest
    /// sizes among those that cannot be told apart, then it leaves least.
    pub(crate) fn closest(
        &self,
        measured: &LinearizedRecording,
        sets: Vec<Vec<EffectIndex>>,
    ) -> Result<Vec<Settled>, MeasureError> {
        let only = sets.len() == 1;
        let mut settled = Vec::with_capacity(sets.len());
        for set in sets {
            let model = self.settle(measured.clone(), &self.all(&set))?;
            let left = if only { 0.0 } else { self.left(&model, &measured.system) };
            settled.push((left, set, model));
        }
        let least = settled.iter().map(|(left, ..)| *left).fold(f64::INFINITY, f64::min);
        let apart =
            if only { 0.0 } else { indistinguishable_below(self.left(measured, &measured.system) - least) };
        settled.retain(|(left, ..)| *left <= least + apart);
        let sizes = |set: &[EffectIndex]| {
            self.columns.iter().filter(|column| column.is_size() && set.contains(&column.effect)).count()
        };
        settled
            .sort_by(|a, b| (sizes(&a.1), a.0).partial_cmp(&(sizes(&b.1), b.0)).unwrap_or(Ordering::Equal));
        Ok(settled.into_iter().map(|(_, set, measured)| (set, measured)).collect())
    }

    /// Named effects, each with one that it is confusable with: one that tied with it when it was taken, or that the
    /// linearised model cannot tell from it, and that leaves as little in its place once it has settled.
    pub(crate) fn confusable(
        &self,
        measured: &LinearizedRecording,
        named: &[EffectIndex],
        ties: &[(EffectIndex, EffectIndex)],
    ) -> Result<Vec<(EffectIndex, EffectIndex)>, MeasureError> {
        let tests = measured.effect_tests(self.columns);
        let all = self.all(named);
        let left = self.left(measured, &measured.system);
        let mut confusable = Vec::new();
        for &effect in named {
            let tied = ties.iter().filter(|(of, other)| *of == effect && !all.contains(other));
            let mut others: Vec<EffectIndex> = tied.map(|(_, other)| *other).collect();
            others.extend(tests.confusable_with(effect, &all));
            others.sort_unstable();
            others.dedup();
            if others.is_empty() {
                continue;
            }
            let without: Vec<EffectIndex> = all.iter().copied().filter(|&other| other != effect).collect();
            let left_without = self.left(&self.settle(measured.clone(), &without)?, &measured.system);
            for other in others {
                let set: Vec<EffectIndex> = without.iter().copied().chain([other]).collect();
                let settled = self.settle(measured.clone(), &set)?;
                if self.left(&settled, &measured.system) < left + indistinguishable_below(left_without - left)
                {
                    confusable.push((effect, other));
                }
            }
        }
        Ok(confusable)
    }

    /// What a settled model leaves, in the standard deviations of `system`. See [`minus_log_likelihood`].
    pub(crate) fn left(&self, measured: &LinearizedRecording, system: &LinearSystem) -> f64 {
        minus_log_likelihood(measured, system, self.columns, self.split)
    }

    /// Fits the effects together and measures anew where they put things, until a step gains nothing (Gauss–Newton).
    pub(crate) fn settle(
        &self,
        mut measured: LinearizedRecording,
        effects: &[EffectIndex],
    ) -> Result<LinearizedRecording, MeasureError> {
        for _ in 0..THRESHOLDS.most_settling_steps {
            (self.progress)(Progress::Fitting);
            let tests = measured.effect_tests(self.columns);
            let Some(fit) = tests.fit_in_range(effects) else { break };
            let still = tests.evidence.improvement(&fit) < THRESHOLDS.settled_gain;
            let model = self.moved(&measured.model, &tests, &fit, effects);
            (self.progress)(Progress::Measuring);
            measured = self.source.linearize(model)?;
            if still {
                break;
            }
        }
        Ok(measured)
    }

    /// The model with only these effects, at the fitted values.
    fn moved(&self, model: &Model, tests: &EffectTests<'_>, fit: &Fit, effects: &[EffectIndex]) -> Model {
        let mut moved = Model::default();
        for &index in effects {
            let effect = index.effect();
            let mut values = model
                .values(effect.id())
                .map_or_else(|| self.source.starting_values(effect), <[f64]>::to_vec);
            // What these frames do not tell of a given effect stays as it was given.
            let stays = |column: &ColumnIndex| self.given.contains(&index) && fit.tells_nothing(*column);
            for column in tests.columns_of(&[index]).into_iter().filter(|column| !stays(column)) {
                values[self.columns[column.0].parameter] = tests.value(fit, column);
            }
            moved = moved.with(effect, values);
        }
        moved
    }
}
