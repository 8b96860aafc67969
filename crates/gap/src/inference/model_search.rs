//! Search for the set of effects that a recording supports: chooses the sets to try next, and settles each of them. A set is
//! settled when it has been fitted until a further step, with everything measured anew at the fitted model, gains nothing.

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
    progress::Progress,
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// Search over sets of effects for one recording.
pub(crate) struct ModelSearch<'a> {
    pub(crate) source: &'a dyn Linearize,
    pub(crate) columns: &'a [FittedParameter],
    pub(crate) split: &'a HeldOutSplit,
    /// Effects that the model had from the start.
    pub(crate) given: &'a [EffectIndex],
    pub(crate) progress: &'a dyn Fn(Progress),
}

/// Set of named effects, with the recording measured at the model in which they have settled.
pub(crate) type Settled = (Vec<EffectIndex>, LinearizedRecording);

impl ModelSearch<'_> {
    /// Returns all effects of a model: the given ones and these named ones.
    fn all(&self, named: &[EffectIndex]) -> Vec<EffectIndex> {
        self.given.iter().chain(named).copied().collect()
    }

    /// Returns the settled model without an effect that is no longer supported, provided that the effect is not supported
    /// beside that smaller model either. The second condition matters because a large effect may seem unsupported once
    /// settled: Wald's test loses power far from zero (Hauck and Donner 1977). `tests` belong to `measured`.
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

    /// Returns the p-value of an effect that is not in the model, corrected for all effects of the library.
    pub(crate) fn p_value(
        &self,
        tests: &EffectTests<'_>,
        named: &[EffectIndex],
        effect: EffectIndex,
    ) -> Option<f64> {
        Some(tests.test(effect, &self.all(named), tests.effects().len())?.p_value)
    }

    /// Returns the sets of named effects to try next, one of which is to be taken: one effect replaced by a better one, one
    /// effect more, or two more. `is_new` is true for sets that have not been tried yet.
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

    /// Settles each of several sets and returns the one to take, followed by those that fit equally well. Among sets whose
    /// fits are indistinguishable, the one to take has the fewest sizes and then the best fit.
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

    /// Returns pairs of a named effect and an effect that it is confusable with. Candidates are effects that tied with the
    /// named one when it was taken, and those that the linearised model cannot distinguish from it. A candidate counts if it
    /// fits as well in the named effect's place once it has settled.
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

    /// Minus log-likelihood of a settled model, in the standard deviations of `system`. See [`minus_log_likelihood`].
    pub(crate) fn left(&self, measured: &LinearizedRecording, system: &LinearSystem) -> f64 {
        minus_log_likelihood(measured, system, self.columns, self.split)
    }

    /// Fits the effects jointly and measures again at the fitted model, until a step gains nothing (Gauss–Newton).
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

    /// Returns the model with only these effects, at the fitted values.
    fn moved(&self, model: &Model, tests: &EffectTests<'_>, fit: &Fit, effects: &[EffectIndex]) -> Model {
        let mut moved = Model::default();
        for &index in effects {
            let effect = index.effect();
            let mut values = model
                .values(effect.id())
                .map_or_else(|| self.source.starting_values(effect), <[f64]>::to_vec);
            // Parameters of a given effect that these frames do not constrain keep their given values.
            let stays = |column: &ColumnIndex| self.given.contains(&index) && fit.tells_nothing(*column);
            for column in tests.columns_of(&[index]).into_iter().filter(|column| !stays(column)) {
                values[self.columns[column.0].parameter] = tests.value(fit, column);
            }
            moved = moved.with(effect, values);
        }
        moved
    }
}
